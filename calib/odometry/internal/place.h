#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calib/odometry/internal/moving_sweep.h"

namespace rgbdt::odometry {

/// What stands about a LIDAR, whichever way it looks: how high above the ground things reach, by
/// distance and direction. After Scan Context (Kim and Kim, IROS 2018), which takes heights from a
/// LIDAR's known height; here the ground is the lowest part of what is seen.
struct Place {
  static constexpr int kRings = 20;    ///< of kReach / kRings each [m]
  static constexpr int kSectors = 60;  ///< of 6 degrees each
  static constexpr double kReach = 40;

  Eigen::Matrix<float, kRings, kSectors> heights;  ///< [m] above the ground; 0: nothing
  Eigen::Matrix<float, kRings, 1> mean;            ///< over the sectors; the same for any yaw
};

/// Of points in the LIDAR's axes [m], z up to within some degrees. Nothing for fewer than 100.
std::optional<Place> PlaceOf(const std::vector<Eigen::Vector3d>& points);

/// How little two places are alike: 0 the same, 1 nothing in common.
struct Unlikeness {
  double value = 1;
  double yaw_rad = 0;  ///< a_from_b: by how much b looks to the left of a, -pi to pi
};
Unlikeness Compare(const Place& a, const Place& b);

}  // namespace rgbdt::odometry
