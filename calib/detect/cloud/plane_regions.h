#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/detect/cloud/range_grid.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// normal . p = offset [m]; the normal is a unit vector towards the LIDAR.
struct Plane {
  Eigen::Vector3d normal{0, 0, 1};
  double offset = 0;

  double Signed(const Eigen::Vector3d& p) const { return normal.dot(p) - offset; }
};

/// Sums of points, from which their plane of least squares follows.
class PlaneSums {
 public:
  void Add(const Eigen::Vector3d& p) {
    sum_ += p;
    squares_.noalias() += p * p.transpose();
    ++count_;
  }
  int count() const { return count_; }
  Eigen::Vector3d Mean() const { return sum_ / count_; }
  /// The plane of least squares; of at least three points.
  Plane Fit() const;
  /// RMS distance of the points from a plane that Fit gave [m].
  double Rms(const Plane& plane) const;

 private:
  Eigen::Matrix3d Scatter() const {
    const Eigen::Vector3d mean = Mean();
    return squares_ / count_ - mean * mean.transpose();
  }

  Eigen::Vector3d sum_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares_ = Eigen::Matrix3d::Zero();
  int count_ = 0;
};

/// A connected piece of a plane: where it lies in the grid. Columns may lie beyond the grid's
/// limits where it wraps, so that a piece is never torn at the seam.
struct PlaneRegion {
  Plane plane;
  std::vector<Eigen::Vector3f> points;  ///< of the cells looked at, every `row_stride`-th and so on
  int first_row = 0, last_row = 0, first_column = 0, last_column = 0;
};

struct PlaneRegionOptions {
  double sigma_m = 0.01;       ///< of a range
  double seed_m = 0.15;        ///< half the side of the patch from which a region starts
  double max_range_m = 14;     ///< boards farther away are not looked for
  double largest_m = 3;        ///< regions with a greater extent are no board
  double smallest_m = 0.9;     ///< the board's shorter side: what decides how finely to look
  double finest_range_m = 10;  ///< the board is still a dozen cells across at this range
};

/// The planar pieces of a grid that are not larger than a board could be. Regions grow from small
/// patches that are plane, over neighbours no farther from the plane than the range noise allows.
/// Looks only at as many cells as a board needs, so a dense cloud costs no more than a sparse one.
std::vector<PlaneRegion> FindPlaneRegions(const RangeGrid& grid, const PlaneRegionOptions& options);

}  // namespace rgbdt
