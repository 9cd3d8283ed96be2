#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/detect/cloud/range_grid.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"

namespace rgbdt {

// The paper's correspondences are picked by a person in the bearing-angle image, on corners of
// whatever stands about. Here a rule picks, and what it picks are the outline corners of a board
// that detection has found: the detection only says about where they are. As a person does, it
// picks a point that was measured, so a corner lies inside of the true one by up to a beam's
// spacing.

struct BoardCornerOptions {
  double range_sigma_m = 0.01;       ///< of a range: what lies on the board's plane
  double edge_rad = 0.349065850399;  ///< 20 deg: as near to 0 or 180 degrees is an edge
  double most_spacings = 2.5;        ///< farther from where detection has the corner: not picked

  /// Throws InputError naming the field and its value.
  void Check() const;
};

/// Points on edges of the bearing-angle images, of the nearer side, that lie on a board: those
/// whose neighbour is far behind, or returned nothing. LIDAR frame [m].
std::vector<Eigen::Vector3d> BoardEdges(const RangeGrid& grid, const CloudEdges& board,
                                        const Target& target,
                                        const BoardCornerOptions& options = {});

/// The outermost of those towards each of the target's outline corners (CloudEdges::corners); NaN
/// where none lies near it. `board` must have a pose.
std::vector<Eigen::Vector3d> PickBoardCorners(const RangeGrid& grid, const CloudEdges& board,
                                              const Target& target,
                                              const BoardCornerOptions& options = {});

}  // namespace rgbdt
