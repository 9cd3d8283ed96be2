#pragma once

#include <cstddef>
#include <vector>

#include "calib/odometry/internal/keyframes.h"

namespace rgbdt::odometry {

/// Loops between keyframes, each from an earlier to a later one, and how many were refused.
struct FoundLoops {
  std::vector<PoseEdge> loops;
  std::size_t tried =
      0;  ///< pairs of places that look alike, or that odometry has beside each other
  std::size_t do_not_fit = 0, against_odometry = 0, alone = 0;  ///< see ClosedWay
};

/// Each keyframe is registered on the maps about the earlier ones that may be the same place: the
/// two that look most alike (place.h), and the one that is nearest by odometry. Loops that odometry
/// cannot be off by, and loops that fewer than two others nearby bear out, are left out.
FoundLoops FindLoops(const KeyframeStore& store);

}  // namespace rgbdt::odometry
