#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calib/model/rigid3.h"

namespace rgbdt {

/// A camera's pose from points and the directions in which it sees them, without a guess: Quan and
/// Lan, Linear N-point camera pose determination (1999). Of each point, every two others give a
/// polynomial of the fourth degree in its squared distance from the camera; all of them together
/// are linear in (1, x, .., x^4), and their null vector tells x. With all distances known the pose
/// is the motion between two sets of points. `points`: LIDAR frame [m]; `directions`: unit, camera
/// axes; as many, five or more. Nothing where they do not tell a pose.
std::optional<Rigid3> PoseFromAngles(const std::vector<Eigen::Vector3d>& points,
                                     const std::vector<Eigen::Vector3d>& directions);

}  // namespace rgbdt
