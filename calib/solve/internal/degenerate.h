#pragma once

#include <string>
#include <vector>

#include "calib/model/rigid3.h"

namespace rgbdt {

/// What a pose is of: how its looseness is put into words.
enum class PoseOf { kCamera, kLidar };

/// Why boards at these places leave a camera's pose loose, and in which direction, in words; empty:
/// they do not. One board, boards all parallel, or all at one
/// place: a shift or a turn of the camera is then told by the boards' edges alone or not at all.
std::string WhyDegenerate(const std::vector<Rigid3>& lidar_from_target,
                          PoseOf of = PoseOf::kCamera);

/// The same by the covariance of delta (the axes of the camera; of a LIDAR the reference's): beyond
/// a degree or 0.1 m, which direction.
std::string WhyLoose(const Matrix6d& covariance, PoseOf of = PoseOf::kCamera);

}  // namespace rgbdt
