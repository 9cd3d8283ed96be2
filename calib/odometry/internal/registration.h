#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/model/rigid3.h"
#include "calib/odometry/internal/moving_sweep.h"
#include "calib/odometry/internal/plane_map.h"

namespace rgbdt::odometry {

using Vector12d = Eigen::Matrix<double, 12, 1>;
using Matrix12d = Eigen::Matrix<double, 12, 12>;

/// Where the LIDAR is at a time and how it moves: errors are (delta, velocity's error), each in
/// LIDAR axes, truth = world_from_lidar * Exp(delta).
struct Motion {
  Rigid3 world_from_lidar;
  Vector6d velocity = Vector6d::Zero();  ///< see OdometryResult
  Matrix12d covariance = Matrix12d::Zero();
};

/// The motion so much later: on with the same velocity, which white acceleration changes. `before`
/// may be `seconds` earlier or later.
Motion Predict(const Motion& before, double seconds, const OdometryOptions& options);

struct Registration {
  Motion motion;           ///< in the sweep's middle
  bool converged = false;  ///< the last step was small
  int iterations = 0;
  std::size_t matched = 0;  ///< of the selected points
  double residual_m = 0;    ///< median distance of these
  double fit = 0;           ///< share of these that lie within 0.1 m of their plane
  /// Directions that the sweep does not tell: orthonormal columns, of a small motion in the
  /// middle's LIDAR axes with turns times `lever_m`.
  Eigen::Matrix<double, 6, Eigen::Dynamic> degenerate;
  double lever_m = 1;  ///< root mean square distance of the matched points
};

/// The motion that puts a sweep's points on the map's planes, with what was known before: Gauss and
/// Newton, with Cauchy's weights on the distances by their median. Where the data do not tell a
/// direction it is left to what was known before; `first`: at the end only, for where hardly
/// anything was known the way there may lead over planes that do not tell.
Registration Register(const TimedSweep& sweep, const PlaneMap& map, const Motion& before,
                      bool first, const OdometryOptions& options);

}  // namespace rgbdt::odometry
