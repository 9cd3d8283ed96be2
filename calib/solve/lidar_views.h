#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"

namespace rgbdt {

/// What a LIDAR beside the reference sees of the target, in its own frame, and what comes of it.
struct LidarViews {
  /// By view: all that looks like the target, likeliest first. Only views in which there is any.
  std::map<std::string, std::vector<CloudEdges>> candidates;
  /// How well a constant that its ranges may be off by is known [m], 1 sigma; 0: it is exact.
  double range_offset_sigma_m = 0;
  std::size_t contradicting = 0;  ///< clouds that were left out as they contradict the others
  LidarReport report;

  /// What detection made of its cloud in a view; without a board with a pose in it, the view is
  /// among the report's rejected ones, with the reason.
  void Add(const std::string& view, const CloudDetection& cloud);
};

/// Of every LIDAR beside the rig's reference, in the rig's order. `range_offset_sigma_m`: as
/// FirstGuessOptions has it where it is not 0, else each LIDAR's own.
std::vector<LidarViews> LidarViewsOf(const Rig& rig, const std::vector<ViewDetection>& detections,
                                     double range_offset_sigma_m);

}  // namespace rgbdt
