#include "calib/files/schema/calibration_file.h"

#include <cmath>
#include <set>

#include "calib/files/atomic_file.h"
#include "calib/files/schema/internal/lens_convert.h"
#include "calib/files/schema/internal/lidar_convert.h"
#include "calib/files/schema/internal/report_parts.h"
#include "calib/files/schema/internal/rig_convert.h"
#include "calib/files/schema/proto_convert.h"
#include "calib/files/schema/report.pb.h"
#include "calib/files/schema/text_proto.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

using text::Place;

constexpr char kComment[] =
    "Where each camera sits, as camera_from_lidar:\n"
    "  point_in_camera = R(quaternion_wxyz) * point_in_lidar + translation_m\n"
    "LIDAR: x forward, y left, z up. Camera: x right, y down, z forward (OpenCV). Metres.\n"
    "A point at z > 0 then goes through the lens to its pixel: the one given here, or else the\n"
    "rig's. The camera's position in the LIDAR frame is -R^T * translation_m. `rgbdt export`\n"
    "writes other tools' files.";

constexpr char kLidars[] =
    "\nOf LIDARs beside the reference, whose frame the LIDAR frame is, reference_from_lidar:\n"
    "  point_in_reference = R(quaternion_wxyz) * point_in_lidar + translation_m";

CameraCalibration ToCamera(const proto::CameraCalibration& camera, const Place& place) {
  if (camera.camera().empty()) place.Fail("camera", "is missing; expected the camera's name");
  CameraCalibration out;
  out.camera = camera.camera();
  out.camera_from_lidar = text::ToRigid3(camera.camera_from_lidar(), place.In("camera_from_lidar"));
  if (camera.has_covariance()) {
    out.covariance = text::ToMatrix(camera.covariance(), place.In("covariance"));
  }
  if (camera.has_lens()) out.lens = text::ToSolvedLens(camera.lens(), place.In("lens"));
  if (camera.has_range_errors()) {
    out.range_errors = text::ToRangeErrors(camera.range_errors(), place.In("range_errors"));
  }
  if (camera.has_timing()) out.timing = text::ToTiming(camera.timing(), place.In("timing"));
  out.status = text::ToStatus(camera.status(), place);
  out.detail = camera.detail();
  return out;
}

void FromCamera(const CameraCalibration& camera, proto::CameraCalibration* out) {
  out->set_camera(ValidUtf8(camera.camera));
  text::FromRigid3(camera.camera_from_lidar, out->mutable_camera_from_lidar());
  if (camera.covariance && camera.covariance->allFinite()) {
    text::FromMatrix(*camera.covariance, out->mutable_covariance());
  }
  if (camera.lens) text::FromSolvedLens(*camera.lens, out->mutable_lens());
  if (camera.range_errors) {
    text::FromRangeErrors(*camera.range_errors, out->mutable_range_errors());
  }
  if (camera.timing) text::FromTiming(*camera.timing, out->mutable_timing());
  out->set_status(text::FromStatus(camera.status));
  out->set_detail(ValidUtf8(camera.detail));
}

}  // namespace

Calibration ReadCalibration(const std::filesystem::path& given) {
  std::error_code none;
  const std::filesystem::path path =
      std::filesystem::is_directory(given, none) ? given / "calibration.textproto" : given;
  proto::Calibration message;
  Place::Tree tree;
  const Place place = text::ParseText(ReadWholeFile(path), path.string(), &message, &tree);
  Calibration calibration{message.method(), message.rig_hash(), message.utime(), {}, {}};
  std::set<std::string> names;
  for (int i = 0; i < message.camera_size(); ++i) {
    const Place at = place.In("camera", i);
    calibration.cameras.push_back(ToCamera(message.camera(i), at));
    if (!names.insert(message.camera(i).camera()).second) {
      at.Fail("camera", "is \"" + message.camera(i).camera() + "\" for the second time");
    }
  }
  for (int i = 0; i < message.lidar_size(); ++i) {
    const Place at = place.In("lidar", i);
    calibration.lidars.push_back(text::ToLidarCalibration(message.lidar(i), at));
    if (!names.insert(message.lidar(i).lidar()).second) {
      at.Fail("lidar", "is \"" + message.lidar(i).lidar() + "\" for the second time");
    }
  }
  if (message.has_sensors()) {
    calibration.sensors = text::ToRig(message.sensors(), place.In("sensors"), LensNeed::kKnown);
  }
  if (calibration.cameras.empty()) {
    place.Fail("camera", "is missing; the file holds no calibrated camera");
  }
  return calibration;
}

std::string PrintCalibration(const Calibration& calibration) {
  proto::Calibration message;
  message.set_method(ValidUtf8(calibration.method));
  message.set_rig_hash(ValidUtf8(calibration.rig_hash));
  message.set_utime(calibration.utime);
  for (const CameraCalibration& camera : calibration.cameras) {
    FromCamera(camera, message.add_camera());
  }
  for (const LidarCalibration& lidar : calibration.lidars) {
    text::FromLidarCalibration(lidar, message.add_lidar());
  }
  if (calibration.sensors) *message.mutable_sensors() = text::FromRig(*calibration.sensors);
  return text::PrintText(message,
                         kComment + std::string(calibration.lidars.empty() ? "" : kLidars));
}

void WriteCalibration(const std::filesystem::path& path, const Calibration& calibration) {
  WriteFileAtomically(path, PrintCalibration(calibration));
}

}  // namespace rgbdt
