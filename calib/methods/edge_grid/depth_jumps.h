#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/model/cloud.h"

namespace rgbdt {

/// A point that stands before another one beside it.
struct DepthJump {
  Eigen::Vector3f point;  ///< LIDAR frame [m]
  float weight = 0;       ///< X of the paper [m^0.5]
};

/// X_p = max(r_{p-1} - r_p, r_{p+1} - r_p, 0)^0.5 (section III of the paper), r being ranges of
/// neighbours along a ring, where the step is more than `least_m` [m]. Two things are left open by
/// the paper. Of a turned scanner, whose lines stand upright, the neighbours are the same beam of
/// the lines beside it: along an upright line all of the ground that is far away is a step. A beam
/// that was fired and returned nothing stands for something as far as the cloud's farthest point:
/// what stands before the sky has the clearest edges in an image, and without it the objective's
/// peak is elsewhere.
std::vector<DepthJump> DepthJumpsOf(const Cloud& cloud, double least_m);

}  // namespace rgbdt
