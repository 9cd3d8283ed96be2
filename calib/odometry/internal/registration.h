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

/// The motion so much later: on with the same velocity, which white acceleration changes
/// (Bar-Shalom et al. 2001, 6.2.2). An acceleration that were constant in between would let each
/// correction of the pose change the velocity by twice its share, so that its error came back with
/// the other sign, as large, sweep after sweep. `before` may be `seconds` earlier or later.
Motion Predict(const Motion& before, double seconds, const OdometryOptions& options);

/// What a time of `seconds` at about this velocity does to a small error of a motion, and the
/// covariance that white acceleration adds to it.
struct Onward {
  Matrix12d transition = Matrix12d::Identity(), noise = Matrix12d::Zero();
};
Onward OnwardOf(const Vector6d& velocity, double seconds, const OdometryOptions& options);

/// By what a motion is off what was expected: (delta, velocity's difference).
Vector12d OffOf(const Motion& expected, const Motion& motion);

struct Registration {
  Motion motion;           ///< in the sweep's middle
  bool converged = false;  ///< the last step was small
  int iterations = 0;
  std::size_t matched = 0;  ///< of the selected points
  double residual_m = 0;    ///< median distance of these
  double fit = 0;           ///< share of these that lie within 0.1 m of their plane
  std::size_t near = 0;     ///< how many of these lie within 0.03 m of it
  /// Directions that the sweep does not tell: orthonormal columns, of a small motion in the
  /// middle's LIDAR axes with turns times `lever_m`.
  Eigen::Matrix<double, 6, Eigen::Dynamic> degenerate;
  double lever_m = 1;  ///< root mean square distance of the matched points
};

/// When a direction that the data do not tell is left to what was known before: from the beginning,
/// or at the end only, where the way there may lead over planes that do not tell.
enum class Untold { kFromTheBeginning, kAtTheEnd };

/// The motion that puts a sweep's points on the map's planes, with what was known before: Gauss and
/// Newton from `start`, with Cauchy's weights on the distances by their median.
Registration Register(const TimedSweep& sweep, const PlaneMap& map, const Motion& before,
                      const Motion& start, Untold untold, const OdometryOptions& options);

}  // namespace rgbdt::odometry
