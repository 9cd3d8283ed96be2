#pragma once

#include <cmath>
#include <vector>

#include "calib/model/cloud.h"
#include "calib/model/rig.h"
#include "calib/model/rigid3.h"
#include "calib/model/view_detection.h"

namespace rgbdt {

/// A rectangle of the target's size before a wall, scanned without noise by a spinning LIDAR of 64
/// rings half a degree apart, 80 degrees wide.
struct ScannedBoard {
  static constexpr double kStepRad = 0.5 * M_PI / 180;
  Target target{9, 6, 0.1, 1.0, 0.7, {0, 0}, {}};
  double wall_m = 7;  ///< the wall's distance, across x
  Rigid3 lidar_from_target;
  Cloud cloud;

  explicit ScannedBoard(const Rigid3& board) : lidar_from_target(board) {
    cloud.lines = 64;
    cloud.beams = 161;
    for (int line = 0; line < cloud.lines; ++line) {
      for (int beam = 0; beam < cloud.beams; ++beam) {
        const double elevation = kStepRad * (line - 32);
        const double azimuth = kStepRad * (80 - beam);
        const Eigen::Vector3d ray(std::cos(azimuth) * std::cos(elevation),
                                  std::sin(azimuth) * std::cos(elevation), std::sin(elevation));
        cloud.points.emplace_back((RangeOf(ray) * ray).cast<float>());
        cloud.directions.emplace_back(ray.cast<float>());
        cloud.ring.push_back(static_cast<std::uint16_t>(line));
      }
    }
  }

  /// What detection would make of it.
  CloudEdges Detected() const {
    CloudEdges board;
    board.centre = lidar_from_target.translation;
    board.normal = -(lidar_from_target.rotation * Eigen::Vector3d::UnitZ());
    board.pose = TargetPose{lidar_from_target, Matrix6d::Identity(), false};
    board.spacing_m =
        kStepRad * board.centre.norm() / std::abs(board.normal.dot(board.centre.normalized()));
    return board;
  }

 private:
  double RangeOf(const Eigen::Vector3d& ray) const {
    const Eigen::Vector3d normal = lidar_from_target.rotation * Eigen::Vector3d::UnitZ();
    const double range = normal.dot(lidar_from_target.translation) / normal.dot(ray);
    const Eigen::Vector3d on = lidar_from_target.Inverse() * Eigen::Vector3d(range * ray);
    const bool hit = range > 0 && std::abs(on.x()) < target.width_m / 2 &&
                     std::abs(on.y()) < target.height_m / 2;
    return hit ? range : wall_m / ray.x();
  }
};

/// A board 3 m before the LIDAR, which it faces, turned by `yaw` and `roll` [rad].
inline Rigid3 BoardBefore(double yaw, double roll) {
  Eigen::Matrix3d axes;  // x to the right, y down, z away from the LIDAR
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const Rigid3 upright{Eigen::Quaterniond(axes), {3, 0.2, -0.1}};
  return upright * RotationAbout({0, 1, 0}, yaw) * RotationAbout({0, 0, 1}, roll);
}

}  // namespace rgbdt
