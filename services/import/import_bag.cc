#include "services/import/import_bag.h"

#include <algorithm>
#include <cstdlib>

#include "calib/files/image_files.h"
#include "calib/files/import/camera_kind.h"
#include "calib/files/session/session_dir.h"
#include "calib/model/errors.h"
#include "calib/model/livox.h"
#include "calib/model/text.h"
#include "services/bags/printable.h"
#include "services/import/image_data.h"
#include "services/import/sensor_data.h"
#include "services/import/transforms.h"

namespace rgbdt {
namespace {

std::string Where(const BagSurvey::Topic& topic, Utime utime) {
  return topic.topic.name + " at utime " + std::to_string(utime);
}

bool IsCalledThermal(const TopicChoice::Camera& camera, bool sixteen_bit = false) {
  return SaysThermal(camera.name, sixteen_bit) ||
         SaysThermal(camera.images->topic.name, sixteen_bit);
}

// Depth in metres looks as degrees Celsius do.
void RequireTemperatures(const TopicChoice::Camera& camera) {
  const std::string& topic = camera.images->topic.name;
  if (camera.images->unit != FloatUnit::kMaybeCelsius || IsCalledThermal(camera, true)) return;
  throw InputError(topic +
                   ": numbers of floating point (32FC1), degrees Celsius or metres of depth; if "
                   "they are temperatures, say --image thermal=" +
                   topic);
}

std::string UnitText(const TopicChoice::Camera& camera) {
  switch (camera.images->unit) {
    case FloatUnit::kKelvin:
      return ", 32FC1 taken for kelvin";
    case FloatUnit::kMaybeCelsius:
      return ", 32FC1 taken for degrees Celsius";
    case FloatUnit::kNone:
      break;
  }
  return "";
}

// Gives what there is to say of it in `why`.
CameraKind KindOf(const TopicChoice::Camera& camera, const Image& first, std::string* why) {
  const std::string& topic = camera.images->topic.name;
  if (camera.images->unit != FloatUnit::kNone) {
    RequireTemperatures(camera);
    return CameraKind::kThermal;
  }
  if (first.format == PixelFormat::kMono16) {
    const auto [kind, by] = KindOfSixteenBit({camera.name, topic}, DarkOverBright(first.pixels));
    if (!by.empty()) {
      *why = ", " + by + "; otherwise say --image " +
             (kind == CameraKind::kThermal ? "rgb=" : "thermal=") + topic;
    }
    return kind;
  }
  if (!IsCalledThermal(camera)) return CameraKind::kColor;
  if (first.format == PixelFormat::kMono8) return CameraKind::kThermal;
  throw InputError(topic +
                   ": a thermal camera by its name, but its images are coloured pictures; expected "
                   "its raw counts (mono16 or mono8), or another name: --image NAME=" +
                   topic);
}

// Calls `decode` with the message; what is wrong with it begins with where it is.
template <typename Decode>
auto DecodeAt(BagReader* bag, const BagSurvey::Topic& topic, const Stamped& stamped,
              Decode decode) {
  const std::string where = Where(topic, stamped.utime);
  const BagMessage message = bag->Read(stamped.place);
  try {
    return decode(message, where);
  } catch (const InputError& error) {
    const std::string what = error.what();
    throw InputError(what.rfind(where, 0) == 0 ? what : where + ": " + what);
  }
}

Image DecodeImage(BagReader* bag, const BagSurvey::Topic& topic, const Stamped& stamped) {
  return DecodeAt(bag, topic, stamped, [&](const BagMessage& message, const std::string& where) {
    Image image = topic.data == BagData::kImage
                      ? ToImage(ros::DecodeImage(message, topic.topic.encoding), where)
                      : ToImage(ros::DecodeCompressedImage(message, topic.topic.encoding), where);
    image.utime = stamped.utime;
    return image;
  });
}

Cloud DecodeCloud(BagReader* bag, const BagSurvey::Topic& topic, const Stamped& stamped) {
  return DecodeAt(bag, topic, stamped, [&](const BagMessage& message, const std::string& where) {
    ros::PointCloud cloud = ros::DecodeCloud(message, topic.topic);
    cloud.header.utime = stamped.utime;
    return ToCloud(cloud, where);
  });
}

// What is measured one after the other, as one cloud without an order.
void Append(const Cloud& part, Cloud* whole) {
  const auto append = [](const auto& from, auto* to) {
    to->insert(to->end(), from.begin(), from.end());
  };
  append(part.points, &whole->points);
  append(part.intensity, &whole->intensity);
  append(part.utime, &whole->utime);
  whole->lines = 1;
  whole->beams = static_cast<int>(whole->size());
  whole->organised = false;
}

// The clouds of a second about this one.
Cloud DecodeSecond(BagReader* bag, const BagSurvey::Topic& topic, const Stamped& middle) {
  const auto before = [](const Stamped& stamped, Utime utime) { return stamped.utime < utime; };
  const auto& all = topic.stamped;
  const auto first =
      std::lower_bound(all.begin(), all.end(), middle.utime - kLivoxCloudUs / 2, before);
  const auto last = std::lower_bound(first, all.end(), middle.utime + kLivoxCloudUs / 2, before);
  Cloud whole;
  whole.sweep_utime = first->utime;
  for (auto part = first; part != last; ++part) {
    Cloud one = DecodeCloud(bag, topic, *part);
    ByHeadersClock(&one);
    Append(one, &whole);
  }
  return whole;
}

std::vector<std::string> NamesOf(const TopicChoice& choice) {
  std::vector<std::string> names;
  for (const TopicChoice::Camera& camera : choice.cameras) names.push_back(camera.name);
  return names;
}

// A file that was given, else the bag's CameraInfo.
std::optional<FileLens> FindLens(const TopicChoice& choice, const RigWishes& wishes,
                                 std::size_t index) {
  const TopicChoice::Camera& camera = choice.cameras[index];
  if (auto given = LensOf(wishes.lenses, NamesOf(choice), index, wishes.model)) return given;
  if (camera.info == nullptr) return std::nullopt;
  LensWanted wanted{camera.info->topic.name,
                    "",
                    camera.name,
                    static_cast<int>(index),
                    static_cast<int>(choice.cameras.size()),
                    wishes.model};
  if (!camera.info->info->distortion_model.empty()) wanted.model.reset();  // it says itself
  return ToLens(*camera.info->info, wanted);
}

// Gives what there is to say of it.
std::string SetLens(const TopicChoice& choice, const RigWishes& wishes, std::size_t index,
                    CameraSpec* spec) {
  const std::optional<FileLens> found = FindLens(choice, wishes, index);
  if (found) {
    CheckLensSize(*found, spec->name, spec->width, spec->height);
    spec->lens = found->lens;
    const BagSurvey::Topic* info = choice.cameras[index].info;
    const bool changes = info != nullptr && info->info_changes && found->where == info->topic.name;
    return NameOf(spec->lens.model) + " lens of " + found->where +
           (changes ? ", which changes within the bag: its first; give --lens FILE if it is another"
                    : "");
  }
  if (!wishes.model || !wishes.board.HasPattern()) {
    throw InputError("camera \"" + spec->name + "\" has no lens: the bag has no CameraInfo of it" +
                     (choice.cameras[index].info != nullptr ? " that is calibrated" : "") +
                     "; give --lens FILE" +
                     (wishes.board.HasPattern()
                          ? ", or say --pinhole or --fisheye and it is found from the images"
                          : ""));
  }
  spec->lens.model = *wishes.model;
  return NameOf(spec->lens.model) + " lens, not known yet";
}

// By tf_static, and a line about it.
std::string SetGuess(const BagSurvey& survey, const TopicChoice& choice,
                     const TopicChoice::Camera& camera, CameraSpec* spec) {
  const std::string& optical = camera.images->frame;
  const std::string& lidar = choice.lidar.clouds->frame;
  spec->camera_from_lidar_guess = FindTransform(survey.transforms, optical, lidar);
  if (!spec->camera_from_lidar_guess) return "";
  const Eigen::Vector3d centre =
      spec->camera_from_lidar_guess->Inverse().translation + Eigen::Vector3d::Zero();  // no -0
  return "guess " + spec->name + "_from_lidar of tf_static: point_in_camera (" +
         Printable(optical) + ", taken as x right, y down, z forward) = R * point_in_lidar (" +
         Printable(lidar) + ") + t; the camera at " +
         Format("%.3f %.3f %.3f m in the LIDAR frame", centre.x(), centre.y(), centre.z());
}

// Of further LIDARs those that there are; what there is to say of them.
std::string AddFurtherClouds(const Rig& rig, const Moment& moment,
                             const std::vector<CloudReader>& read_clouds, View* view,
                             std::vector<std::string>* left_over) {
  std::string line;
  for (std::size_t i = 0; i < moment.further_clouds.size(); ++i) {
    const std::string& lidar = rig.further_lidars[i].name;
    const auto& stamped = moment.further_clouds[i];
    if (!stamped) {
      line += "  " + lidar + ": none";
      continue;
    }
    try {
      view->further_clouds.push_back({lidar, read_clouds[i + 1](*stamped)});
      line += "  " + lidar + ": " +
              Format("%+.0f ms", 1e3 * ToSeconds(stamped->utime - moment.cloud.utime));
    } catch (const InputError& error) {
      left_over->push_back(error.what());
    }
  }
  return line;
}

}  // namespace

BagRig ReadRig(BagReader* bag, const BagSurvey& survey, const TopicChoice& choice,
               const RigWishes& wishes) {
  CheckLensFiles(wishes.lenses, NamesOf(choice));
  BagRig out;
  out.rig.lidar.name = choice.lidar.name;
  out.rig.target = wishes.board;
  for (std::size_t i = 0; i < choice.cameras.size(); ++i) {
    const TopicChoice::Camera& camera = choice.cameras[i];
    const Image first = DecodeImage(bag, *camera.images, camera.images->stamped.front());
    CameraSpec spec;
    spec.name = camera.name;
    spec.format = first.format;
    std::string why = UnitText(camera);
    spec.kind = KindOf(camera, first, &why);
    if (spec.kind == CameraKind::kColor && spec.format == PixelFormat::kMono16) {
      spec.format = PixelFormat::kMono8;
    }
    spec.radiometry = first.radiometry;
    spec.width = first.pixels.cols;
    spec.height = first.pixels.rows;
    const std::string lens = SetLens(choice, wishes, i, &spec);
    out.lines.push_back("camera " + spec.name + ": " +
                        (spec.kind == CameraKind::kThermal ? "thermal" : "colour") + ", " +
                        std::to_string(spec.width) + "x" + std::to_string(spec.height) + ", " +
                        lens + why + "; " + camera.images->topic.name);
    const std::string guess = SetGuess(survey, choice, camera, &spec);
    if (!guess.empty()) out.lines.push_back(guess);
    out.rig.cameras.push_back(spec);
  }
  out.lines.push_back((choice.further_lidars.empty()
                           ? "lidar: "
                           : "lidar " + choice.lidar.name + " (the reference): ") +
                      choice.lidar.clouds->topic.name + ", " + choice.lidar.clouds->what);
  for (const TopicChoice::Lidar& lidar : choice.further_lidars) {
    out.rig.further_lidars.emplace_back().name = lidar.name;
    out.lines.push_back("lidar " + lidar.name + ": " + lidar.clouds->topic.name + ", " +
                        lidar.clouds->what);
  }
  out.rig.Check(LensNeed::kMayBeUnknown);
  return out;
}

CloudReader CloudMessages(BagReader* bag, const BagSurvey::Topic& topic) {
  return [bag, &topic](const Stamped& stamped) {
    return topic.livox ? DecodeSecond(bag, topic, stamped) : DecodeCloud(bag, topic, stamped);
  };
}

Image ReadImageAsItIs(BagReader* bag, const TopicChoice::Camera& camera, CameraKind kind,
                      const Stamped& stamped) {
  Image image = DecodeImage(bag, *camera.images, stamped);
  image.camera = camera.name;
  if (kind == CameraKind::kColor && image.format == PixelFormat::kMono16) {
    EightBits(&image.pixels);
    image.format = PixelFormat::kMono8;
  }
  return image;
}

bool ByHeadersClock(Cloud* cloud) {
  constexpr Utime kOneClock = 10 * kMicrosecondsPerSecond;  // longer than any sweep
  std::vector<Utime> times;
  for (std::size_t i = 0; i < cloud->utime.size(); ++i) {
    if (cloud->IsHit(i)) times.push_back(cloud->utime[i]);
  }
  if (times.empty()) return false;
  // Of single points that have no time the others' tells.
  const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
  std::nth_element(times.begin(), middle, times.end());
  if (std::abs(*middle - cloud->sweep_utime) < kOneClock) return false;
  Utime first = *middle;
  for (const Utime utime : times) {
    if (*middle - utime < kOneClock) first = std::min(first, utime);
  }
  const Utime later = cloud->sweep_utime - first;
  for (Utime& utime : cloud->utime) utime += later;
  return true;
}

Image ReadImage(BagReader* bag, const TopicChoice::Camera& camera, const CameraSpec& spec,
                const Stamped& stamped) {
  Image image = ReadImageAsItIs(bag, camera, spec.kind, stamped);
  image.camera = spec.name;
  const bool alike = image.pixels.cols == spec.width && image.pixels.rows == spec.height &&
                     image.format == spec.format;
  if (alike) return image;
  throw InputError(Where(*camera.images, stamped.utime) + ": is " +
                   std::to_string(image.pixels.cols) + "x" + std::to_string(image.pixels.rows) +
                   " " + NameOf(image.format) + ", the first one " + std::to_string(spec.width) +
                   "x" + std::to_string(spec.height) + " " + NameOf(spec.format) +
                   "; expected images of one kind in a topic");
}

std::size_t WriteMoments(BagReader* bag, const TopicChoice& choice, const Rig& rig,
                         const std::vector<Moment>& moments,
                         const std::vector<CloudReader>& read_clouds,
                         const std::filesystem::path& dir,
                         const std::function<void(const std::string&)>& progress,
                         std::vector<std::string>* left_over) {
  const Utime start = StartOf(choice);
  std::size_t views = 0;
  for (const Moment& moment : moments) {
    View view;
    view.name = Format("%04zu", views + 1);
    view.heldout = views % 3 == 2;
    try {
      view.cloud = read_clouds[0](moment.cloud);
    } catch (const InputError& error) {
      left_over->push_back(error.what());
      continue;
    }
    std::string line =
        view.name + ": cloud at " + Fixed(ToSeconds(moment.cloud.utime - start), 2) + " s";
    for (std::size_t i = 0; i < choice.cameras.size(); ++i) {
      const std::string& camera = rig.cameras[i].name;
      if (!moment.images[i]) {
        line += "  " + camera + ": none";
        continue;
      }
      try {
        view.images.push_back(ReadImage(bag, choice.cameras[i], rig.cameras[i], *moment.images[i]));
        line += "  " + camera + ": " +
                Format("%+.0f ms", 1e3 * ToSeconds(moment.images[i]->utime - moment.cloud.utime));
      } catch (const InputError& error) {
        left_over->push_back(error.what());
      }
    }
    if (view.images.empty()) continue;
    line += AddFurtherClouds(rig, moment, read_clouds, &view, left_over);
    WriteView(dir, view);
    ++views;
    if (progress) progress(line);
  }
  if (views == 0) {
    throw InputError("no moment of the bag can be used" +
                     (left_over->empty() ? "" : ": " + left_over->back()));
  }
  WriteRig(dir, rig);
  return views;
}

}  // namespace rgbdt
