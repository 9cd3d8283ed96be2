#include "calib/files/import/lens_file.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "calib/files/atomic_file.h"
#include "calib/files/import/internal/yaml_tree.h"
#include "calib/model/errors.h"
#include "calib/model/printable.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

using yaml::Node;

constexpr char kKnownModels[] =
    "plumb_bob (radtan), rational_polynomial and equidistant (fisheye); leave --lens out and say "
    "--pinhole or --fisheye, and the lens is found from the images";

std::optional<Node> FindMatrix(const Node& node) {
  return node.Find({"camera_matrix", "K", "intrinsic_matrix", "mtx"});
}

std::optional<Node> FindDistortion(const Node& node) {
  return node.Find({"distortion_coefficients", "distortion_coeffs", "dist_coeffs", "dist_coeff",
                    "distortion", "dist", "D"});
}

bool IsLens(const Node& node) {
  return FindMatrix(node).has_value() || node.Find({"intrinsics"}).has_value();
}

using Part = std::pair<std::string, Node>;

std::string RostopicOf(const Node& node) {
  const std::optional<Node> topic = node.Find({"rostopic"});
  return topic && topic->IsText() ? topic->Text() : "";
}

// "/thermal/image_raw" names "thermal".
bool TopicNames(const std::string& topic, const std::string& camera) {
  return ("/" + topic + "/").find("/" + camera + "/") != std::string::npos;
}

std::string ListOf(const std::vector<Part>& parts) {
  std::string list;
  for (const auto& [name, node] : parts) {
    const std::string topic = RostopicOf(node);
    list += (list.empty() ? "" : ", ") + name + (topic.empty() ? "" : " (" + topic + ")");
  }
  return list;
}

// The only part for which `is` holds.
template <typename Is>
const Part* Only(const std::vector<Part>& parts, Is is) {
  const Part* found = nullptr;
  for (const Part& part : parts) {
    if (!is(part)) continue;
    if (found != nullptr) return nullptr;
    found = &part;
  }
  return found;
}

const Part& Choose(const std::vector<Part>& parts, const LensWanted& wanted) {
  const auto called = [&](const std::string& name) {
    return Only(parts, [&](const Part& part) { return part.first == name; });
  };
  const std::string file = wanted.file.string();
  if (!wanted.entry.empty()) {
    if (const Part* part = called(wanted.entry)) return *part;
    throw InputError(file + " has no \"" + wanted.entry + "\"; it has: " + ListOf(parts));
  }
  if (parts.size() == 1) return parts[0];
  if (const Part* part = called(wanted.camera)) return *part;
  const auto by_topic = [&](const Part& part) {
    return TopicNames(RostopicOf(part.second), wanted.camera);
  };
  if (const Part* part = Only(parts, by_topic)) return *part;
  if (parts.size() == static_cast<std::size_t>(wanted.cameras)) {
    return parts[static_cast<std::size_t>(wanted.index)];
  }
  throw InputError(file + " holds " + std::to_string(parts.size()) + " cameras, " + ListOf(parts) +
                   "; say which one is \"" + wanted.camera + "\": --lens " + wanted.camera + "=" +
                   file + ":" + parts[0].first);
}

// The whole file, or its parts.
std::vector<Part> LensesIn(const Node& root, const LensWanted& wanted) {
  if (IsLens(root)) return {{"", root}};
  std::vector<Part> parts;
  for (const Part& part : root.Entries()) {
    if (IsLens(part.second)) parts.push_back(part);
  }
  if (parts.empty()) {
    throw InputError(wanted.file.string() +
                     " holds no lens; expected camera_matrix (OpenCV), K (ROS camera_info) or "
                     "cam0 with intrinsics (Kalibr)");
  }
  return parts;
}

void ReadMatrix(const Node& node, Lens* lens) {
  const std::vector<double> k = node.Numbers();
  if (k.size() != 9) {
    node.Fail("has " + std::to_string(k.size()) + " numbers; expected 9, fx 0 cx 0 fy cy 0 0 1");
  }
  if (k[0] == 0 && k[4] == 0) node.Fail("is zero: this camera was never calibrated");
  if (k[1] != 0) {
    node.Fail("has a skew of " + Exact(k[1]) + ", which no lens here has; expected 0");
  }
  if (k[3] != 0 || k[6] != 0 || k[7] != 0 || k[8] != 1) {
    node.Fail("is no camera matrix; expected fx 0 cx 0 fy cy 0 0 1, row by row");
  }
  lens->fx = k[0];
  lens->cx = k[2];
  lens->fy = k[4];
  lens->cy = k[5];
}

// Kalibr: fu fv pu pv, of its camera_model "pinhole" only.
void ReadIntrinsics(const Node& part, const Node& node, Lens* lens) {
  const std::optional<Node> model = part.Find({"camera_model"});
  if (model && yaml::Plain(model->Text()) != "pinhole") {
    model->Fail("is \"" + model->Text() +
                "\", which no lens here can express; expected pinhole with " +
                std::string(kKnownModels));
  }
  const std::vector<double> numbers = node.Numbers();
  if (numbers.size() != 4) {
    node.Fail("has " + std::to_string(numbers.size()) + " numbers; expected 4, fu fv pu pv");
  }
  lens->fx = numbers[0];
  lens->fy = numbers[1];
  lens->cx = numbers[2];
  lens->cy = numbers[3];
}

void ReadFocalAndCentre(const Node& part, Lens* lens) {
  const std::optional<Node> matrix = FindMatrix(part);
  const Node node = matrix ? *matrix : *part.Find({"intrinsics"});
  if (matrix) {
    ReadMatrix(node, lens);
  } else {
    ReadIntrinsics(part, node, lens);
  }
  if (!(lens->fx > 0 && lens->fy > 0)) node.Fail("has no positive focal lengths");
}

// What the file says of its model; absent: nothing.
std::optional<Lens::Model> StatedModel(const Node& part) {
  const std::optional<Node> fisheye = part.Find({"fisheye_model"});  // OpenCV's calibration sample
  if (fisheye) return fisheye->Number() != 0 ? Lens::Model::kFisheye : Lens::Model::kPinhole;
  const std::optional<Node> node = part.Find({"distortion_model"});
  if (!node) return std::nullopt;
  const std::string name = yaml::Plain(node->Text());
  for (const char* pinhole : {"plumbbob", "radtan", "rationalpolynomial", "none", "pinhole"}) {
    if (name == pinhole) return Lens::Model::kPinhole;
  }
  for (const char* equidistant : {"equidistant", "fisheye", "kannalabrandt"}) {
    if (name == equidistant) return Lens::Model::kFisheye;
  }
  if (name.empty()) return std::nullopt;
  node->Fail("is \"" + node->Text() + "\", which no lens here can express; expected " +
             std::string(kKnownModels));
}

std::string ModelName(Lens::Model model) {
  return model == Lens::Model::kFisheye ? "fisheye" : "pinhole";
}

bool SaysNone(const Node& part) {
  const std::optional<Node> model = part.Find({"distortion_model"});
  return model && yaml::Plain(model->Text()) == "none";
}

Lens::Model ModelOf(const Node& part, const Node& distortion, std::size_t count,
                    const LensWanted& wanted) {
  const std::optional<Lens::Model> stated = StatedModel(part);
  if (stated && wanted.model && *stated != *wanted.model) {
    throw InputError(wanted.file.string() + " says that its lens is a " + ModelName(*stated) +
                     ", but --" + ModelName(*wanted.model) + " is given; leave it out");
  }
  if (stated) return *stated;
  if (wanted.model) return *wanted.model;
  if (count != 4) return Lens::Model::kPinhole;
  distortion.Fail(
      "has 4 numbers, and the file does not say whether they are OpenCV's k1 k2 p1 p2 or a "
      "fisheye's k1 k2 k3 k4: add --pinhole or --fisheye");
}

// What lies beyond the coefficients that the model has must be zero.
void ReadDistortion(const Node& node, Lens* lens) {
  const std::vector<double> k = node.Numbers();
  const bool fisheye = lens->model == Lens::Model::kFisheye;
  const std::size_t most = fisheye ? 4 : 8;
  for (std::size_t i = most; i < k.size(); ++i) {
    if (k[i] == 0) continue;
    node.Fail("has " + Exact(k[i]) + " as number " + std::to_string(i + 1) + "; a " +
              ModelName(lens->model) + " lens has " + std::to_string(most) + " here" +
              (fisheye ? "" : ", no thin prism and no tilt") +
              ": leave --lens out, and it is found from the images");
  }
  const std::size_t count = k.size();
  const bool good = count == 0 || count == 4 || count >= most || (!fisheye && count == 5);
  if (!good) {
    node.Fail("has " + std::to_string(count) + " numbers; expected " +
              (fisheye ? "4" : "4, 5 or 8, in OpenCV's order"));
  }
  std::copy(k.begin(), k.begin() + static_cast<std::ptrdiff_t>(std::min(count, most)),
            lens->distortion.begin());
}

int Pixels(const Node& node, double value) {
  if (!(value >= 1 && value <= 20000)) node.Fail("is " + Exact(value) + "; expected 1 to 20000 px");
  return static_cast<int>(value);
}

void ReadSize(const Node& part, FileLens* out) {
  const std::optional<Node> both = part.Find({"resolution", "image_size"});
  if (both) {
    const std::vector<double> size = both->Numbers();
    if (size.size() != 2) both->Fail("holds no width and height");
    out->width = Pixels(*both, size[0]);
    out->height = Pixels(*both, size[1]);
  }
  const std::optional<Node> width = part.Find({"image_width", "width"});
  const std::optional<Node> height = part.Find({"image_height", "height"});
  if (width && height) {
    out->width = Pixels(*width, width->Number());
    out->height = Pixels(*height, height->Number());
  }
}

// ROS: the images are a part of the sensor, or rows and columns of it taken together.
void CheckWhole(const Node& part) {
  const std::optional<Node> roi = part.Find({"roi"});
  if (!roi) return;
  for (const char* field : {"x_offset", "y_offset"}) {
    const std::optional<Node> offset = roi->Find({field});
    if (offset && offset->Number() != 0) {
      offset->Fail("is " + Exact(offset->Number()) +
                   ": the images are cut out of larger ones; expected images of the whole sensor");
    }
  }
}

FileLens Parse(const std::string& text, const LensWanted& wanted) {
  const std::string file = wanted.file.string();
  if (text.find_first_not_of(" \t\r\n") == std::string::npos) {
    throw InputError(file + " is empty; expected a lens as YAML");
  }
  if (text.rfind("<?xml", 0) == 0) {
    throw InputError(file +
                     " is XML; expected YAML: cv::FileStorage writes it to a name that ends in "
                     ".yaml");
  }
  const std::vector<Part> parts = LensesIn(Node::Parse(text, file), wanted);
  const auto& [name, part] = Choose(parts, wanted);
  FileLens out;
  out.parts = static_cast<int>(parts.size());
  out.where = name.empty() ? file : file + ":" + PrintableText(name);
  ReadFocalAndCentre(part, &out.lens);
  ReadSize(part, &out);
  CheckWhole(part);
  const std::optional<Node> distortion = FindDistortion(part);
  if (SaysNone(part)) return out;
  if (!distortion) {
    throw InputError(out.where +
                     " has no distortion_coefficients; expected them, or [] where there are none");
  }
  out.lens.model = ModelOf(part, *distortion, distortion->Numbers().size(), wanted);
  ReadDistortion(*distortion, &out.lens);
  return out;
}

}  // namespace

FileLens ParseLensFile(const std::string& text, const LensWanted& wanted) {
  try {
    return Parse(text, wanted);
  } catch (const InputError& error) {
    // Names and texts of YAML may have several lines; an error has one.
    throw InputError(PrintableText(error.what()));
  }
}

FileLens ReadLensFile(const LensWanted& wanted) {
  return ParseLensFile(ReadWholeFile(wanted.file), wanted);
}

void CheckLensSize(const FileLens& lens, const std::string& camera, int width, int height) {
  const auto size = [](int w, int h) { return std::to_string(w) + "x" + std::to_string(h); };
  const std::string images = "the images of camera \"" + camera + "\" are " + size(width, height);
  if (lens.width == 0) {
    const Lens& l = lens.lens;
    if (l.cx >= 0 && l.cx <= width && l.cy >= 0 && l.cy <= height) return;
    throw InputError(lens.where + ": the centre cx " + Exact(l.cx) + ", cy " + Exact(l.cy) +
                     " lies outside: " + images + "; the lens is of images of another size");
  }
  if (lens.width == width && lens.height == height) return;
  const double factor = static_cast<double>(width) / lens.width;
  const bool scaled = std::abs(height - factor * lens.height) <= 1;
  throw InputError(lens.where + " is of images of " + size(lens.width, lens.height) + ", but " +
                   images +
                   (scaled ? ", " + Format("%.4g", factor) + " times as large"
                           : ": cut out of them, or of another camera") +
                   "; give the images as the lens was made from, or a lens made from these");
}

}  // namespace rgbdt
