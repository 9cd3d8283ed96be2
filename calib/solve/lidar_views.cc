#include "calib/solve/lidar_views.h"

#include <utility>

namespace rgbdt {

void LidarViews::Add(const std::string& view, const CloudDetection& cloud) {
  std::vector<CloudEdges> found;
  for (const CloudEdges& candidate : cloud.candidates) {
    if (candidate.pose) found.push_back(candidate);
  }
  if (!found.empty()) {
    candidates[view] = std::move(found);
  } else {
    report.rejected.push_back(
        {view, cloud.why_not.empty() ? "the board was not found in the cloud" : cloud.why_not});
  }
}

std::vector<LidarViews> LidarViewsOf(const Rig& rig, const std::vector<ViewDetection>& detections,
                                     double range_offset_sigma_m) {
  std::vector<LidarViews> all;
  for (const LidarSpec& lidar : rig.further_lidars) {
    LidarViews& views = all.emplace_back();
    views.report.calibration.lidar = lidar.name;
    views.range_offset_sigma_m =
        range_offset_sigma_m > 0 ? range_offset_sigma_m : lidar.range_offset_sigma_m;
    for (const ViewDetection& detection : detections) {
      if (detection.heldout) continue;
      for (const LidarDetection& further : detection.further_clouds) {
        if (further.lidar == lidar.name) views.Add(detection.view, further.cloud);
      }
    }
  }
  return all;
}

}  // namespace rgbdt
