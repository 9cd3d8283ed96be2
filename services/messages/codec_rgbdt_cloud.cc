#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "services/messages/check.h"
#include "services/messages/internal/codec_types.h"
#include "services/messages/internal/fields.h"

namespace rgbdt {
namespace {

void CheckLengths(const RgbdtCloud& cloud) {
  const std::size_t size = cloud.size();
  CheckLength("calibration_utime", cloud.calibration_utime.size(), cloud.cameras.size(), false);
  CheckLength("intensity", cloud.intensity.size(), size, false);
  CheckLength("utime", cloud.utime.size(), size, false);
  CheckLength("rgb", cloud.rgb.size(), size, false);
  CheckLength("temperature_k", cloud.temperature_k.size(), size, false);
  CheckLength("temperature_sigma_k", cloud.temperature_sigma_k.size(), size, false);
  CheckLength("thermal_counts", cloud.thermal_counts.size(), size, false);
  CheckLength("valid", cloud.valid.size(), size, false);
}

void Resize(std::size_t size, rgbdt_cloud_t* wire) {
  wire->x_m.resize(size);
  wire->y_m.resize(size);
  wire->z_m.resize(size);
  wire->utime_offset_us.resize(size);
  wire->red.resize(size);
  wire->green.resize(size);
  wire->blue.resize(size);
  wire->valid.resize(size);
}

// The earliest and the latest stand for those between them.
void CheckTimes(const std::vector<Utime>& utime, Utime first) {
  if (utime.empty()) return;
  const auto [low, high] = std::minmax_element(utime.begin(), utime.end());
  for (const Utime extreme : {*low, *high}) {
    CheckUtime("utime", extreme);
    CheckRange("utime_offset_us", extreme - first, std::numeric_limits<std::int32_t>::min(),
               std::numeric_limits<std::int32_t>::max());
  }
}

void PointsToWire(const RgbdtCloud& cloud, rgbdt_cloud_t* wire) {
  CheckTimes(cloud.utime, wire->utime);
  Resize(cloud.size(), wire);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    wire->x_m[i] = cloud.points[i].x();
    wire->y_m[i] = cloud.points[i].y();
    wire->z_m[i] = cloud.points[i].z();
    wire->utime_offset_us[i] = static_cast<std::int32_t>(cloud.utime[i] - wire->utime);
    wire->red[i] = cloud.rgb[i][0];
    wire->green[i] = cloud.rgb[i][1];
    wire->blue[i] = cloud.rgb[i][2];
    wire->valid[i] = static_cast<std::int32_t>(cloud.valid[i]);
  }
}

void PointsFromWire(const rgbdt_cloud_t& wire, RgbdtCloud* cloud) {
  const std::size_t size = wire.x_m.size();
  cloud->points.resize(size);
  cloud->utime.resize(size);
  cloud->rgb.resize(size);
  cloud->valid.resize(size);
  for (std::size_t i = 0; i < size; ++i) {
    cloud->points[i] = {wire.x_m[i], wire.y_m[i], wire.z_m[i]};
    cloud->utime[i] = wire.utime + wire.utime_offset_us[i];
    cloud->rgb[i] = {wire.red[i], wire.green[i], wire.blue[i]};
    cloud->valid[i] = static_cast<std::uint32_t>(wire.valid[i]);
  }
}

void CheckCoordinates(const rgbdt_cloud_t& wire) {
  const auto within = [](float v) { return std::abs(v) <= kMaxMetres; };  // not so for NaN
  unsigned bad = 0;
  for (std::size_t i = 0; i < wire.x_m.size(); ++i) {
    bad |= static_cast<unsigned>(!within(wire.x_m[i])) |
           static_cast<unsigned>(!within(wire.y_m[i])) |
           static_cast<unsigned>(!within(wire.z_m[i]));
  }
  for (std::size_t i = 0; bad != 0; ++i) {
    if (within(wire.x_m[i]) && within(wire.y_m[i]) && within(wire.z_m[i])) continue;
    Fail(At("point", i),
         "(" + std::to_string(wire.x_m[i]) + ", " + std::to_string(wire.y_m[i]) + ", " +
             std::to_string(wire.z_m[i]) + ") m",
         "finite numbers up to 1e6");
  }
}

// NaN stands for an unknown value: it compares as neither too small nor too large.
void CheckPoints(const rgbdt_cloud_t& wire) {
  constexpr float kMost = std::numeric_limits<float>::max();
  CheckCoordinates(wire);
  CheckEach(
      "intensity", wire.intensity, [](float v) { return !(v < 0) & !(v > 1); },
      "0 to 1, or NaN: unknown");
  CheckEach(
      "temperature_k", wire.temperature_k, [](float v) { return !(v < 0) & !(v > kMost); },
      "0 or more, or NaN: unknown");
  CheckEach(
      "temperature_sigma_k", wire.temperature_sigma_k,
      [](float v) { return !(v < 0) & !(v > kMost); }, "0 or more, or NaN: unknown");
  CheckEach(
      "thermal_counts", wire.thermal_counts, [](float v) { return !(std::abs(v) > kMost); },
      "a number, or NaN: unknown");
  const Utime earliest = std::max<Utime>(1 - wire.utime, std::numeric_limits<std::int32_t>::min());
  CheckEach(
      "utime_offset_us", wire.utime_offset_us,
      [least = static_cast<std::int32_t>(earliest)](std::int32_t v) { return v >= least; },
      "a time after 1970");
  const auto cameras = static_cast<std::uint32_t>((std::uint64_t{1} << wire.num_cameras) - 1);
  CheckEach(
      "valid", wire.valid,
      [cameras](std::int32_t v) { return (static_cast<std::uint32_t>(v) & ~cameras) == 0; },
      "bits of the cameras named only");
}

void CheckPose(const rgbdt_cloud_t& wire) {
  CheckUtime("frame_utime", wire.frame_utime);
  CheckRotation("quaternion_wxyz", wire.quaternion_wxyz);
  CheckFinite("translation_m", wire.translation_m, 3);
}

}  // namespace

// All but the points, the pose and utime.
template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, rgbdt_cloud_t>& wire,
            StructOf<Copy, RgbdtCloud>& cloud) {
  copy(wire.seq, cloud.seq);
  copy(wire.sweep_utime, cloud.sweep_utime);
  copy(wire.sweep_end, cloud.sweep_end);
  copy(wire.whole_sweep, cloud.whole_sweep);
  copy.List("num_cameras", wire.num_cameras, wire.camera, cloud.cameras);
  copy(wire.calibration_utime, cloud.calibration_utime);
}

rgbdt_cloud_t ToWire(const RgbdtCloud& cloud) {
  CheckLengths(cloud);
  auto wire = FieldsToWire<rgbdt_cloud_t>(cloud);
  wire.utime = cloud.utime.empty() ? cloud.sweep_utime : cloud.utime.front();
  CheckUtime("utime", wire.utime);
  if (cloud.map_from_lidar) {
    wire.has_pose = 1;
    wire.frame_utime = cloud.frame_utime;
    CopyToWire().Pose(wire.quaternion_wxyz, wire.translation_m, *cloud.map_from_lidar);
  }
  wire.num_points = CountOf(cloud.size(), "num_points");
  wire.intensity = cloud.intensity;
  wire.temperature_k = cloud.temperature_k;
  wire.temperature_sigma_k = cloud.temperature_sigma_k;
  wire.thermal_counts = cloud.thermal_counts;
  PointsToWire(cloud, &wire);
  return wire;
}

void Check(const rgbdt_cloud_t& wire) {
  CheckUtime("utime", wire.utime);
  CheckUtime("sweep_utime", wire.sweep_utime);
  CheckRange("num_cameras", wire.num_cameras, 0, kMaxCameras);
  for (std::size_t i = 0; i < wire.camera.size(); ++i) {
    CheckCameraName(At("camera", i), wire.camera[i]);
    CheckUtimeOrZero(At("calibration_utime", i), wire.calibration_utime[i]);
  }
  if (wire.has_pose != 0) CheckPose(wire);
  CheckPoints(wire);
}

RgbdtCloud FromWire(rgbdt_cloud_t wire) {
  auto cloud = FieldsFromWire<RgbdtCloud>(wire);
  if (wire.has_pose != 0) {
    cloud.frame_utime = wire.frame_utime;
    CopyFromWire().Pose(wire.quaternion_wxyz, wire.translation_m, cloud.map_from_lidar.emplace());
  }
  cloud.intensity = std::move(wire.intensity);
  cloud.temperature_k = std::move(wire.temperature_k);
  cloud.temperature_sigma_k = std::move(wire.temperature_sigma_k);
  cloud.thermal_counts = std::move(wire.thermal_counts);
  PointsFromWire(wire, &cloud);
  return cloud;
}

}  // namespace rgbdt
