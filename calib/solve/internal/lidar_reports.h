#pragma once

#include <string>
#include <vector>

#include "calib/solve/internal/joint_solve.h"
#include "calib/solve/lidar_views.h"

namespace rgbdt {

/// What the further LIDARs do to the cameras that they must not, in words; empty: nothing. They add
/// to what the cameras' own views say, so that no camera moves by more than it is known to.
std::string WhyLidarsDoNotFit(const JointResult& result);

/// Their reports say why they have no pose.
std::vector<LidarViews> LeftOut(std::vector<LidarViews> lidars, const std::string& why);

/// Each further LIDAR's report: its pose with covariance, what was found of it.
std::vector<LidarReport> ReportsOfLidars(const JointResult& result, int min_views);

}  // namespace rgbdt
