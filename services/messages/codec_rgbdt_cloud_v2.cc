#include <limits>
#include <utility>

#include "services/messages/check.h"
#include "services/messages/internal/codec_types.h"

namespace rgbdt {
namespace {

void PoseToWire(const RgbdtCloud& cloud, rgbdt_cloud_v2_t* wire) {
  wire->has_pose = static_cast<std::int8_t>(cloud.map_from_lidar.has_value());
  if (!cloud.map_from_lidar) return;
  wire->frame_utime = cloud.frame_utime;
  RotationToWire(cloud.map_from_lidar->rotation, wire->quaternion_wxyz);
  Eigen::Map<Eigen::Vector3d>(wire->translation_m) = cloud.map_from_lidar->translation;
}

void CheckPose(const rgbdt_cloud_v2_t& wire) {
  CheckUtime("frame_utime", wire.frame_utime);
  CheckRotation("quaternion_wxyz", wire.quaternion_wxyz);
  CheckFinite("translation_m", wire.translation_m, 3);
}

// A NaN, neither below 0 nor above the largest number, says: unknown.
void CheckSigmas(const rgbdt_cloud_v2_t& wire) {
  CheckLength("temperature_sigma_k", wire.temperature_sigma_k.size(), wire.cloud.x_m.size(), false);
  constexpr float kMost = std::numeric_limits<float>::max();
  CheckEach(
      "temperature_sigma_k", wire.temperature_sigma_k,
      [](float v) { return !(v < 0) & !(v > kMost); }, "0 or more, or NaN: unknown");
}

}  // namespace

rgbdt_cloud_v2_t ToWire(const RgbdtCloud& cloud) {
  rgbdt_cloud_v2_t wire{};
  wire.cloud = ToFirstVersion(cloud);
  wire.whole_sweep = static_cast<std::int8_t>(cloud.whole_sweep);
  wire.num_calibrations = CountOf(cloud.calibration_utime.size(), "num_calibrations");
  wire.camera_calibration_utime.assign(cloud.calibration_utime.begin(),
                                       cloud.calibration_utime.end());
  PoseToWire(cloud, &wire);
  wire.num_sigmas = CountOf(cloud.temperature_sigma_k.size(), "num_sigmas");
  wire.temperature_sigma_k = cloud.temperature_sigma_k;
  return wire;
}

void Check(const rgbdt_cloud_v2_t& wire) {
  Check(wire.cloud);
  CheckLength("camera_calibration_utime", wire.camera_calibration_utime.size(),
              wire.cloud.camera.size(), false);
  for (std::size_t i = 0; i < wire.camera_calibration_utime.size(); ++i) {
    CheckUtimeOrZero(At("camera_calibration_utime", i), wire.camera_calibration_utime[i]);
  }
  if (wire.has_pose != 0) CheckPose(wire);
  CheckSigmas(wire);
}

RgbdtCloud FromWire(rgbdt_cloud_v2_t wire) {
  RgbdtCloud cloud = FromWire(std::move(wire.cloud));
  cloud.whole_sweep = wire.whole_sweep != 0;
  cloud.calibration_utime.assign(wire.camera_calibration_utime.begin(),
                                 wire.camera_calibration_utime.end());
  if (wire.has_pose != 0) {
    cloud.frame_utime = wire.frame_utime;
    cloud.map_from_lidar = Rigid3{RotationFromWire(wire.quaternion_wxyz),
                                  Eigen::Map<const Eigen::Vector3d>(wire.translation_m)};
  }
  cloud.temperature_sigma_k = std::move(wire.temperature_sigma_k);
  return cloud;
}

}  // namespace rgbdt
