#include <algorithm>
#include <cmath>
#include <limits>

#include "services/bus/check.h"
#include "services/bus/codec_types.h"

namespace rgbdt {
namespace {

constexpr std::int64_t kMaxCameras = 32;  // bits of `valid`

void CheckLengths(const RgbdtCloud& cloud) {
  const std::size_t size = cloud.size();
  CheckLength("intensity", cloud.intensity.size(), size, false);
  CheckLength("utime", cloud.utime.size(), size, false);
  CheckLength("rgb", cloud.rgb.size(), size, false);
  CheckLength("temperature_k", cloud.temperature_k.size(), size, false);
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

void PointsToWire(const RgbdtCloud& cloud, rgbdt_cloud_t* wire) {
  Resize(cloud.size(), wire);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    wire->x_m[i] = cloud.points[i].x();
    wire->y_m[i] = cloud.points[i].y();
    wire->z_m[i] = cloud.points[i].z();
    CheckUtime("utime", cloud.utime[i]);
    const std::int64_t offset = cloud.utime[i] - wire->utime;
    CheckRange("utime_offset_us", offset, std::numeric_limits<std::int32_t>::min(),
               std::numeric_limits<std::int32_t>::max());
    wire->utime_offset_us[i] = static_cast<std::int32_t>(offset);
    wire->red[i] = cloud.rgb[i][0];
    wire->green[i] = cloud.rgb[i][1];
    wire->blue[i] = cloud.rgb[i][2];
    wire->valid[i] = static_cast<std::int32_t>(cloud.valid[i]);
  }
}

bool Within(float v) { return std::abs(v) <= kMaxMetres; }  // not so for NaN

void CheckPoint(const rgbdt_cloud_t& wire, std::size_t i, std::uint32_t cameras) {
  if (!Within(wire.x_m[i]) || !Within(wire.y_m[i]) || !Within(wire.z_m[i])) {
    Fail(At("point", i),
         "(" + std::to_string(wire.x_m[i]) + ", " + std::to_string(wire.y_m[i]) + ", " +
             std::to_string(wire.z_m[i]) + ") m",
         "finite numbers up to 1e6");
  }
  const float intensity = wire.intensity[i];
  if (!std::isnan(intensity) && !(intensity >= 0 && intensity <= 1)) {
    Fail(At("intensity", i), intensity, "0 to 1, or NaN: unknown");
  }
  if (wire.temperature_k[i] < 0 || std::isinf(wire.temperature_k[i])) {
    Fail(At("temperature_k", i), wire.temperature_k[i], "0 or more, or NaN: unknown");
  }
  if (std::isinf(wire.thermal_counts[i])) {
    Fail(At("thermal_counts", i), wire.thermal_counts[i], "a number, or NaN: unknown");
  }
  if (wire.utime + wire.utime_offset_us[i] <= 0) {
    Fail(At("utime_offset_us", i), wire.utime_offset_us[i], "a time after 1970");
  }
  if ((static_cast<std::uint32_t>(wire.valid[i]) & ~cameras) != 0) {
    Fail(At("valid", i), wire.valid[i], "bits of the cameras named only");
  }
}

}  // namespace

rgbdt_cloud_t ToWire(const RgbdtCloud& cloud) {
  CheckLengths(cloud);
  rgbdt_cloud_t wire;
  wire.utime = cloud.utime.empty() ? cloud.sweep_utime : cloud.utime.front();
  CheckUtime("utime", wire.utime);
  wire.seq = cloud.seq;
  wire.sweep_utime = cloud.sweep_utime;
  wire.sweep_end = static_cast<std::int8_t>(cloud.sweep_end);
  wire.calibration_utime =
      cloud.calibration_utime.empty()
          ? 0
          : *std::max_element(cloud.calibration_utime.begin(), cloud.calibration_utime.end());
  wire.num_cameras = CountOf(cloud.cameras.size(), "num_cameras");
  wire.camera = cloud.cameras;
  wire.num_points = CountOf(cloud.size(), "num_points");
  wire.intensity = cloud.intensity;
  wire.temperature_k = cloud.temperature_k;
  wire.thermal_counts = cloud.thermal_counts;
  PointsToWire(cloud, &wire);
  return wire;
}

void Check(const rgbdt_cloud_t& wire) {
  CheckUtime("utime", wire.utime);
  CheckSeq(wire.seq);
  CheckUtime("sweep_utime", wire.sweep_utime);
  CheckUtimeOrZero("calibration_utime", wire.calibration_utime);
  CheckRange("num_cameras", wire.num_cameras, 0, kMaxCameras);
  for (std::size_t i = 0; i < wire.camera.size(); ++i) {
    CheckCameraName(At("camera", i), wire.camera[i]);
  }
  const auto cameras = static_cast<std::uint32_t>((std::uint64_t{1} << wire.num_cameras) - 1);
  for (std::size_t i = 0; i < wire.x_m.size(); ++i) CheckPoint(wire, i, cameras);
}

RgbdtCloud FromWire(const rgbdt_cloud_t& wire) {
  RgbdtCloud cloud;
  cloud.seq = wire.seq;
  cloud.sweep_utime = wire.sweep_utime;
  cloud.calibration_utime.assign(wire.camera.size(), wire.calibration_utime);
  cloud.sweep_end = wire.sweep_end != 0;
  cloud.cameras = wire.camera;
  cloud.intensity = wire.intensity;
  cloud.temperature_k = wire.temperature_k;
  cloud.thermal_counts = wire.thermal_counts;
  cloud.temperature_sigma_k.assign(wire.x_m.size(), std::numeric_limits<float>::quiet_NaN());
  const std::size_t size = wire.x_m.size();
  cloud.points.resize(size);
  cloud.utime.resize(size);
  cloud.rgb.resize(size);
  cloud.valid.resize(size);
  for (std::size_t i = 0; i < size; ++i) {
    cloud.points[i] = {wire.x_m[i], wire.y_m[i], wire.z_m[i]};
    cloud.utime[i] = wire.utime + wire.utime_offset_us[i];
    cloud.rgb[i] = {wire.red[i], wire.green[i], wire.blue[i]};
    cloud.valid[i] = static_cast<std::uint32_t>(wire.valid[i]);
  }
  return cloud;
}

}  // namespace rgbdt
