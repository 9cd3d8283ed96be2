#include <algorithm>
#include <cstring>

#include "calib/files/atomic_file.h"
#include "calib/files/image_files.h"
#include "calib/files/points/cloud_files.h"
#include "calib/files/schema/proto_convert.h"
#include "calib/files/schema/session.pb.h"
#include "calib/files/schema/text_proto.h"
#include "calib/files/session/session_dir.h"
#include "calib/model/errors.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;
using text::Place;

constexpr Utime kSameTime = 60 * kMicrosecondsPerSecond;

// The session that a view is in, and its name there: those of a joined one's part.
struct InSession {
  const Session& session;
  std::string view;
};

InSession Find(const Session& session, const std::string& view) {
  for (const Session::Part& part : session.parts) {
    const std::string start = part.name + "/";
    if (view.rfind(start, 0) == 0) return {part.session, view.substr(start.size())};
  }
  return {session, view};
}

std::size_t IndexOf(const Session& session, const std::string& view) {
  const auto found =
      std::lower_bound(session.views.begin(), session.views.end(), view, NaturalLess);
  if (found != session.views.end() && *found == view) {
    return static_cast<std::size_t>(found - session.views.begin());
  }
  constexpr std::size_t kFew = 20;
  std::string names;
  for (std::size_t i = 0; i < std::min(kFew, session.views.size()); ++i) {
    names += (names.empty() ? "" : ", ") + session.views[i];
  }
  if (session.views.size() > kFew) {
    names += " and " + std::to_string(session.views.size() - kFew) + " more";
  }
  throw InputError("the session " + session.root.string() + " has no view \"" + view +
                   "\"; it has: " + names);
}

// Runs `read`, and says which field of which file asked for what it could not read.
template <typename Read>
auto ReadFor(const Place& place, const std::string& field, Read read) {
  try {
    return read();
  } catch (const InputError& error) {
    throw InputError(place.Describe(field) + ": " + error.what());
  }
}

Radiometry ReadRadiometry(const proto::ViewImage& image, const CameraSpec& camera,
                          const Place& place) {
  Radiometry radiometry = camera.radiometry;
  if (image.has_linear()) radiometry = text::ToRadiometry(image.linear(), place.In("linear"));
  if (image.has_planck()) radiometry = text::ToRadiometry(image.planck(), place.In("planck"));
  radiometry.emissivity = camera.radiometry.emissivity;
  radiometry.reflected_temperature_k = camera.radiometry.reflected_temperature_k;
  if (image.emissivity() != 0) radiometry.emissivity = image.emissivity();
  if (image.reflected_temperature_k() != 0) {
    radiometry.reflected_temperature_k = image.reflected_temperature_k();
  }
  if (!(radiometry.emissivity > 0 && radiometry.emissivity <= 1)) {
    place.Fail("emissivity", "is " + std::to_string(image.emissivity()) + "; expected 0 to 1");
  }
  text::RequireFinite(image.reflected_temperature_k(), place, "reflected_temperature_k");
  return radiometry;
}

void CheckPixels(const CameraSpec& camera, const Image& image, const std::string& file,
                 const Place& place) {
  const cv::Mat& pixels = image.pixels;
  if (camera.kind == CameraKind::kThermal && pixels.channels() != 1) {
    place.Fail("file", file + " has " + std::to_string(pixels.channels()) +
                           " channels, but camera \"" + camera.name +
                           "\" is thermal: give its raw counts (one channel, 16 or 8 bit), not a "
                           "coloured picture of them");
  }
  if (camera.kind == CameraKind::kColor && pixels.depth() != CV_8U) {
    place.Fail("file", file + " has neither 8 nor 16 bit, but camera \"" + camera.name +
                           "\" is a colour camera: convert it to 8-bit grey, Bayer or colour");
  }
  if (pixels.cols != camera.width || pixels.rows != camera.height) {
    place.Fail("file", file + " is " + std::to_string(pixels.cols) + "x" +
                           std::to_string(pixels.rows) + " px, but the rig says " +
                           std::to_string(camera.width) + "x" + std::to_string(camera.height) +
                           " for camera \"" + camera.name +
                           "\": the lens parameters belong to that size");
  }
}

Image ReadImage(const proto::ViewImage& message, const Rig& rig, const fs::path& folder,
                const Place& place) {
  const CameraSpec& camera = ReadFor(
      place, "camera",
      [&]() -> std::reference_wrapper<const CameraSpec> { return rig.Camera(message.camera()); });
  if (message.file().empty()) place.Fail("file", "is missing; expected the image's path");
  const fs::path file = folder / message.file();
  Image image;
  image.camera = camera.name;
  image.pixels = ReadFor(place, "file", [&] { return DecodeImageFile(file); });
  if (camera.kind == CameraKind::kThermal) image.pixels = OneChannelOfGrey(image.pixels);
  image.utime = message.utime();
  image.frame_number = message.frame_number();
  image.device_utime = message.device_utime();
  image.exposure_s = message.exposure_s();
  image.shutter_correcting = message.shutter_correcting();
  image.radiometry = ReadRadiometry(message, camera, place);
  if (camera.kind == CameraKind::kColor) EightBits(&image.pixels);
  // Before the format: of all that can be wrong with a thermal image, three channels come first.
  CheckPixels(camera, image, file.string(), place);
  image.format = ReadFor(place, "file", [&] {
    try {
      return FormatOf(static_cast<PixelFormat>(message.pixel_format()), &image.pixels);
    } catch (const InputError& error) {
      throw InputError(file.string() + " " + error.what());
    }
  });
  return image;
}

CornerSelection ReadPicks(const proto::ViewImage& message, const Image& image, const Place& place) {
  const Place at = place.In("picked");
  text::RequireNumbers(message.picked().corner_px(), 8, at, "corner_px");
  CornerSelection picks;
  picks.camera = image.camera;
  picks.utime = image.utime;
  picks.image_utime = image.utime;
  for (int i = 0; i < 4; ++i) {
    picks.corners[static_cast<std::size_t>(i)] = {message.picked().corner_px(2 * i),
                                                  message.picked().corner_px(2 * i + 1)};
  }
  return picks;
}

void CheckTimes(const proto::View& message, const Image& image, const Place& place) {
  const Utime sweep = message.sweep_utime();
  if (sweep == 0 || image.utime == 0) return;
  const double apart = ToSeconds(image.utime) - ToSeconds(sweep);
  if (std::abs(apart) <= ToSeconds(kSameTime)) return;
  place.Fail("utime", "is " + std::to_string(image.utime) + ", " + std::to_string(apart) +
                          " s after the cloud's sweep_utime " + std::to_string(sweep) +
                          ": cloud and image belong to different times; name the files of one "
                          "moment (0: time unknown)");
}

const std::string& LidarNameOf(const LidarSpec& lidar) { return lidar.name; }
const std::string& LidarNameOf(const LidarCloud& cloud) { return cloud.lidar; }

enum class WithCloud { kYes, kNo };

// view.textproto, of which `place` says where its fields stand.
struct ViewFile {
  std::size_t index;  ///< of the view in its session
  fs::path folder;
  proto::View message;
  Place::Tree tree;
};

// `file` is kept by who calls: the place refers to its tree.
Place ReadViewFile(const Session& any, const std::string& name, ViewFile* file) {
  const auto [session, view] = Find(any, name);
  file->index = IndexOf(session, view);
  file->folder = session.root / "views" / view;
  const fs::path path = file->folder / "view.textproto";
  if (!fs::exists(path)) {
    throw InputError(path.string() +
                     " is missing; it names the view's cloud and images, as "
                     "calib/files/README.md shows");
  }
  Place place = text::ParseText(ReadWholeFile(path), path.string(), &file->message, &file->tree);
  if (std::abs(ToSeconds(file->message.sweep_utime())) > 1e11) {
    place.Fail("sweep_utime", "is " + std::to_string(file->message.sweep_utime()) +
                                  "; expected microseconds since 1970");
  }
  return place;
}

void RequireCloud(const ViewFile& file, const Place& place) {
  if (file.message.cloud().empty()) place.Fail("cloud", "is missing; expected the PCD file's path");
}

Cloud ReadCloudOf(const ViewFile& file, const Place& place) {
  const fs::path cloud = file.folder / file.message.cloud();
  return ReadFor(place, "cloud", [&] { return ReadSweep(cloud, file.message.sweep_utime()); });
}

// Of LIDARs beside the rig's reference; a view need not have one of each.
std::vector<LidarCloud> ReadFurtherClouds(const ViewFile& file, const Rig& rig,
                                          const Place& place) {
  std::vector<LidarCloud> clouds;
  for (int i = 0; i < file.message.further_cloud_size(); ++i) {
    const proto::FurtherCloud& message = file.message.further_cloud(i);
    const Place at = place.In("further_cloud", i);
    const auto is_it = [&](const auto& of) { return LidarNameOf(of) == message.lidar(); };
    if (std::none_of(rig.further_lidars.begin(), rig.further_lidars.end(), is_it)) {
      at.Fail("lidar", "is \"" + message.lidar() +
                           "\"; expected the name of one of the rig's LIDARs after the first");
    }
    if (std::any_of(clouds.begin(), clouds.end(), is_it)) {
      at.Fail("lidar", "is \"" + message.lidar() + "\" for the second time");
    }
    if (message.file().empty()) at.Fail("file", "is missing; expected the PCD file's path");
    const fs::path path = file.folder / message.file();
    clouds.push_back({message.lidar(), ReadFor(at, "file", [&] {
                        return ReadSweep(path, file.message.sweep_utime());
                      })});
  }
  return clouds;
}

// To the bit, and where there was no return, too.
bool SamePoints(const Cloud& a, const Cloud& b) {
  return !a.points.empty() && a.points.size() == b.points.size() &&
         std::memcmp(a.points.data(), b.points.data(), a.points.size() * sizeof a.points[0]) == 0;
}

View Read(const Session& session, const std::string& view, WithCloud with_cloud) {
  ViewFile file;
  const Place place = ReadViewFile(session, view, &file);
  const proto::View& message = file.message;
  const bool cloud = with_cloud == WithCloud::kYes;
  if (cloud) RequireCloud(file, place);
  if (message.image_size() == 0) place.Fail("image", "is missing; expected image { ... }");

  View result;
  result.name = view;
  result.heldout = message.has_heldout() ? message.heldout() : file.index % 3 == 2;
  if (message.has_map_from_lidar()) {
    result.map_from_lidar = ToRigid3(message.map_from_lidar(), place.In("map_from_lidar"));
  }
  for (int i = 0; i < message.image_size(); ++i) {
    const Place at = place.In("image", i);
    result.images.push_back(ReadImage(message.image(i), session.rig, file.folder, at));
    CheckTimes(message, result.images.back(), at);
    if (message.image(i).has_picked()) {
      result.picks.push_back(ReadPicks(message.image(i), result.images.back(), at));
    }
  }
  if (cloud) {
    result.cloud = ReadCloudOf(file, place);
    result.further_clouds = ReadFurtherClouds(file, session.rig, place);
    for (std::size_t i = 0; i < result.further_clouds.size(); ++i) {
      if (!SamePoints(result.further_clouds[i].cloud, result.cloud)) continue;
      place.In("further_cloud", static_cast<int>(i))
          .Fail("file", "holds the points of the view's own cloud; expected those of LIDAR \"" +
                            result.further_clouds[i].lidar + "\"");
    }
  }
  return result;
}

}  // namespace

View ReadView(const Session& session, const std::string& view) {
  return Read(session, view, WithCloud::kYes);
}

View ReadImages(const Session& session, const std::string& view) {
  return Read(session, view, WithCloud::kNo);
}

Cloud ReadCloud(const Session& session, const std::string& view) {
  ViewFile file;
  const Place place = ReadViewFile(session, view, &file);
  RequireCloud(file, place);
  return ReadCloudOf(file, place);
}

}  // namespace rgbdt
