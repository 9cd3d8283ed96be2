#pragma once

#include <cstddef>
#include <vector>

#include "calib/odometry/internal/moving_sweep.h"
#include "calib/odometry/internal/place.h"
#include "calib/odometry/internal/plane_map.h"
#include "calib/odometry/internal/pose_graph.h"
#include "calib/odometry/loop_closure.h"

namespace rgbdt::odometry {

/// A sweep that stands for a stretch of the way.
struct Keyframe {
  TimedSweep sweep;  ///< thinned out
  Rigid3 world_from_middle;
  Vector6d velocity = Vector6d::Zero();    ///< see OdometryResult
  Matrix6d covariance = Matrix6d::Zero();  ///< likewise
  double residual_m = 0;                   ///< of its points from odometry's map, median
  double way_m = 0;                        ///< since the first keyframe
  Place place;
};

/// The keyframes of a drive and the ways between them. When there are too many, every second one
/// goes, and later ones are twice as far apart.
class KeyframeStore {
 public:
  KeyframeStore(const LoopClosureOptions& options, const OdometryOptions& odometry)
      : options_(options), odometry_(odometry) {}

  void Add(const Cloud& cloud, const OdometryResult& found);

  const LoopClosureOptions& options() const { return options_; }
  const OdometryOptions& odometry() const { return odometry_; }
  const std::vector<Keyframe>& frames() const { return frames_; }
  /// From each keyframe to the next one.
  const std::vector<PoseEdge>& chain() const { return chain_; }

  /// The way from one keyframe to another, forth or back, as the chain's covariances have it.
  PoseEdge Between(std::size_t from, std::size_t to) const;
  /// Likewise, from an earlier one, as uncertain as odometry drifts in the long run.
  PoseEdge ByOdometry(std::size_t from, std::size_t to) const;
  /// What stands about a keyframe, seen from those up to `about_m` before and after it, in its own
  /// axes.
  PlaneMap MapAbout(std::size_t index) const;

 private:
  bool IsFar(const OdometryResult& found) const;
  void AddEdge(const OdometryResult& found, double* way_m);
  void Halve();

  LoopClosureOptions options_;
  OdometryOptions odometry_;
  std::vector<Keyframe> frames_;
  std::vector<PoseEdge> chain_;
  double apart_ = 1;      // of the options' distances
  bool unknown_ = false;  // the way since the last keyframe
};

}  // namespace rgbdt::odometry
