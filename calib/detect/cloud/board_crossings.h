#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/detect/cloud/plane_regions.h"
#include "calib/detect/cloud/range_grid.h"
#include "calib/model/view_detection.h"

namespace rgbdt {

/// Two axes in a plane and the place they start from: what is flat is easier in two dimensions.
struct PlaneFrame {
  Eigen::Vector3d origin{0, 0, 0};
  Eigen::Vector3d u{1, 0, 0}, v{0, 1, 0};  ///< unit, in the plane; u x v points away from the LIDAR

  PlaneFrame(const Plane& plane, const Eigen::Vector3d& near);
  Eigen::Vector2d Flat(const Eigen::Vector3d& p) const {
    return {u.dot(p - origin), v.dot(p - origin)};
  }
  Eigen::Vector3d Solid(const Eigen::Vector2d& p) const { return origin + p.x() * u + p.y() * v; }
};

/// Where a row or column of beams leaves the plane: the truth lies between the last beam on it and
/// the first beyond, cells in which none was fired left out. Places in the plane's frame [m].
struct FlatCrossing {
  Eigen::Vector2d middle{0, 0};   ///< of the two beams
  Eigen::Vector2d outward{0, 0};  ///< unit, from the last beam on the plane to the first beyond
  double half_m = 0;              ///< half of the distance between the two
  double length_m = 0;            ///< how much of a side it stands for, were the side across it
  double range_m = 0;             ///< from the LIDAR
  Eigen::Vector2d slope{0, 0};    ///< how far the beam moves along the plane per metre of depth
  CrossingKind kind = CrossingKind::kNoReturn;
  std::size_t cell = 0;    ///< of the last beam: one cell may be crossed along and across
  bool along_row = false;  ///< the two beams are neighbours in a row
  std::size_t gap = 0;     ///< the last beam's column (along a row) or row
};

/// A plane's beams in the grid at full resolution.
struct PlaneMembers {
  Plane plane;  ///< fitted to all of them
  PlaneFrame frame;
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector2d> flat;     ///< where their beams meet the plane
  std::vector<int> row;                  ///< of the grid, e.g. the ring
  std::vector<std::size_t> index;        ///< of the point in the cloud
  std::vector<Eigen::Vector2d> through;  ///< where beams went through the plane and hit beyond
  std::vector<FlatCrossing> crossings;
  double row_spacing_m = 0, column_spacing_m = 0;  ///< between neighbouring beams on the plane
  double beam_m2 = 0;                              ///< of the plane, that one beam stands for
};

struct MemberOptions {
  double sigma_m = 0.01;            ///< of a range
  Eigen::Vector3d middle{0, 0, 0};  ///< of what is looked at
  double reach_m = 1;               ///< no farther from there
  double fit_reach_m = 1;           ///< the plane is fitted to what is no farther from there
};

/// Looks again, at every beam, at the part of the grid where a region was found.
PlaneMembers FindMembers(const RangeGrid& grid, const PlaneRegion& region,
                         const MemberOptions& options);

}  // namespace rgbdt
