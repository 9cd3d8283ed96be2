#include "calib/model/rgbdt_cloud.h"

#include <algorithm>

#include "calib/model/slice.h"

namespace rgbdt {
namespace {

RgbdtCloud PartOf(const RgbdtCloud& cloud, std::size_t first, std::size_t end) {
  RgbdtCloud part;
  part.seq = cloud.seq;
  part.sweep_utime = cloud.sweep_utime;
  part.sweep_end = cloud.sweep_end && end == cloud.size();
  part.whole_sweep = cloud.whole_sweep;
  part.cameras = cloud.cameras;
  part.calibration_utime = cloud.calibration_utime;
  part.map_from_lidar = cloud.map_from_lidar;
  part.frame_utime = cloud.frame_utime;
  part.points = Slice(cloud.points, first, end);
  part.intensity = Slice(cloud.intensity, first, end);
  part.utime = Slice(cloud.utime, first, end);
  part.rgb = Slice(cloud.rgb, first, end);
  part.temperature_k = Slice(cloud.temperature_k, first, end);
  part.temperature_sigma_k = Slice(cloud.temperature_sigma_k, first, end);
  part.thermal_counts = Slice(cloud.thermal_counts, first, end);
  part.valid = Slice(cloud.valid, first, end);
  return part;
}

}  // namespace

std::vector<RgbdtCloud> PartsOf(RgbdtCloud cloud, std::size_t most) {
  std::vector<RgbdtCloud> parts;
  if (cloud.size() <= most) {
    parts.push_back(std::move(cloud));
    return parts;
  }
  for (std::size_t first = 0; first < cloud.size(); first += most) {
    parts.push_back(PartOf(cloud, first, std::min(cloud.size(), first + most)));
  }
  return parts;
}

}  // namespace rgbdt
