#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "calib/detect/cloud/board_crossings.h"
#include "calib/detect/cloud/plane_regions.h"

namespace rgbdt {

/// Points on a board, in the order of their rows.
struct BoardPoints {
  std::vector<Eigen::Vector3d> points;  ///< [m, LIDAR]
  std::vector<Eigen::Vector2d> flat;    ///< where their beams meet the frame's plane
  std::vector<int> row;                 ///< their rows in the grid: a ring, a line
  std::vector<std::size_t> index;       ///< in the cloud
  std::vector<double> log2_intensity;   ///< Log2Intensity; 0 where the cloud does not tell
};

/// What the points of one row have in common, and what they have not. `weights`: the sum of the
/// row's weights, each within^2 over the point's own variance.
struct RowNoise {
  double within_m = 0;   ///< sigma of a point of weight one about its row, as if independent
  double between_m = 0;  ///< sigma of a row about the plane: its range bias

  /// What the correlated noise of a row takes off the points' weights w: the inverse of
  /// within^2 diag(w)^-1 + between^2 11' is (diag(w) - correlated w w') / within^2.
  double Correlated(double weights) const;
};

/// The plane of a board's points and how exactly they tell it. `near` is a plane some millimetres
/// off and `frame` its frame; `least_sigma_m` is what the noise is at least. The arguments must
/// outlive it. Dark points are noisier than bright ones (an OS1's three times): each counts by the
/// variance that its brightness has on this board, and neighbours in a row whose noise is alike
/// (an OS1's by 0.4 to 0.6) count for less.
class BoardPlane {
 public:
  BoardPlane(const Plane& near, const PlaneFrame& frame, const BoardPoints& points,
             double least_sigma_m);

  const Plane& plane() const { return plane_; }
  double sigma_m() const { return noise_.within_m; }

  /// CloudEdges::groups about a centre, and the sigma within them of a point of weight one.
  /// `one_laser`: see BoardInCloudOptions.
  struct Groups {
    std::vector<PointGroup> groups;
    double sigma_m = 0;
  };
  Groups GroupsAbout(const Eigen::Vector3d& centre, const Cloud& cloud, bool one_laser) const;

  /// CloudEdges::scatter and raw_scatter about a centre.
  Eigen::Matrix4d Scatter(const Eigen::Vector3d& centre) const;
  Eigen::Matrix4d RawScatter(const Eigen::Vector3d& centre) const;

 private:
  Eigen::Vector3d AlongNormal(std::size_t i) const;
  Plane FitAlongRays() const;
  std::vector<double> OffPlane() const;

  const Plane& near_;
  const PlaneFrame& frame_;
  const BoardPoints& points_;
  double least_sigma_m_;
  std::vector<double> weight_;  // of each point; one in the mean
  double alike_ = 1;  // times the variance of independent noise, as neighbours share theirs
  RowNoise noise_{1, 0};
  Plane plane_;
};

}  // namespace rgbdt
