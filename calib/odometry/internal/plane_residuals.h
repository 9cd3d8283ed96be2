#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "calib/model/rigid3.h"
#include "calib/odometry/internal/moving_sweep.h"
#include "calib/odometry/internal/plane_map.h"

namespace rgbdt::odometry {

inline constexpr double kNearPlane = 0.03;  ///< [m]

/// A point on a plane: r = normal . (point - mean), with its derivative by a small motion of the
/// LIDAR in the middle of the sweep, or of its part.
struct Residual {
  std::size_t part = 0;
  Match match;
  Eigen::Vector3d in_middle = Eigen::Vector3d::Zero();
  double seconds = 0;  ///< after the part's middle
  double distance = 0;
  Vector6d slope = Vector6d::Zero();
  double weight = 0;
  double common = 0;  ///< variance of what the plane is off by, for all of its points [m^2]
};

/// How the points of a sweep lie on a map's planes.
class PlaneResiduals {
 public:
  explicit PlaneResiduals(const PlaneMap& map) : map_(map) {}

  void Clear() { all_.clear(); }
  /// The selected points of a part of the sweep. `match`: they look for their planes; else those
  /// of `matches` stay, which has one for each.
  void Add(std::size_t part, const TimedSweep& sweep, const SweepMotion& motion, bool match,
           std::vector<Match>* matches);
  /// Cauchy's weights on the distances, whose scale follows their median where `scale` says so; but
  /// their width is `least_width_m` at least, for points that have not found their place.
  /// What a plane is off by is common to its points: together they tell no more than that lets
  /// them.
  void Weigh(bool scale, double least_width_m = 0);
  /// Of a point whose own scatter is this [m].
  double WeightOf(const Residual& r, double scatter) const;

  const std::vector<Residual>& all() const { return all_; }
  double scale_m() const { return scale_; }
  double median_m() const { return median_; }
  double lever_m() const { return lever_; }   ///< root mean square distance from the middle
  double fit() const { return fit_; }         ///< share within 0.1 m of their plane
  std::size_t near() const { return near_; }  ///< how many within kNearPlane

 private:
  const PlaneMap& map_;
  std::vector<Residual> all_;
  double scale_ = 1, width_ = 2, median_ = 0, lever_ = 1, fit_ = 0;
  std::size_t near_ = 0;
};

}  // namespace rgbdt::odometry
