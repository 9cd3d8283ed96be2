#pragma once

#include <Eigen/Core>
#include <string>

#include "calib/model/rigid3.h"

namespace rgbdt {

/// What most of a small motion of a camera is (delta, rigid3.h), each number over its sigma: 0 to 2
/// a turn about the camera's x, y, z, 3 to 5 a move along them.
Eigen::Index MainNumber(const Vector6d& delta, const Vector6d& sigma);

/// "a turn about the camera's y (yaw)"
std::string DirectionWords(Eigen::Index number);

/// What a scene needs for that number to be told: "vertical edges".
std::string NeededFor(Eigen::Index number);

}  // namespace rgbdt
