#pragma once

#include <optional>
#include <vector>

#include "calib/model/rig.h"
#include "calib/sync/internal/quadratic.h"
#include "calib/sync/internal/spline.h"
#include "calib/sync/sync.h"

namespace rgbdt::sync {

/// How points are told to be the board's.
struct OnBoard {
  double margin_m = 0.04;  ///< from the outline inwards
  double gate_m = 0.1;     ///< farther from the board along the beam: it is something else
  double sigma_m = 0.01;   ///< of a range
};

/// What a sweep tells of the board's way.
struct SweepMotion {
  double seconds = 0;  ///< when the beams were on the board, since the trajectory's start
  Rigid3 lidar_from_target;
  Vector6d twist;  ///< as Trajectory::TwistAt
  /// Of xi = (delta; twist; how much longer ranges are than true): a point at time t is on
  ///   Exp(delta + (t - seconds) (twist - the way's)) * the way at t.
  Quadratic quadratic;
  double square = 0;  ///< of the residuals [sigma]
};

/// The points whose beams meet the board where the way puts it, and are as far away. Nothing where
/// there are fewer than 30 of them. A residual is a length along the beam: noise lies along it.
std::optional<SweepMotion> LineariseSweep(const WavedSweep& sweep, const Target& target,
                                          const Trajectory& way, double range_offset_m,
                                          const OnBoard& options);

/// Of each sweep within the way's time the points in a cone about the board, half a metre wider
/// than it.
std::vector<WavedSweep> AboutBoard(const std::vector<WavedSweep>& sweeps, const Target& target,
                                   const Trajectory& way);

/// Where a beam meets the board's plane: along it [m], and the place on the board. Nothing behind.
struct MetBoard {
  double range = 0;
  Eigen::Vector2d place{0, 0};
};
std::optional<MetBoard> MeetBoard(const Rigid3& lidar_from_target, const Eigen::Vector3d& beam);

/// Whether a place [m] lies on the board, this far inside its outline.
inline bool IsOn(const Target& target, const Eigen::Vector2d& place, double margin_m) {
  return std::abs(place.x()) < 0.5 * target.width_m - margin_m &&
         std::abs(place.y()) < 0.5 * target.height_m - margin_m;
}

}  // namespace rgbdt::sync
