#pragma once

#include <vector>

#include "calib/detect/cloud/range_grid.h"
#include "calib/methods/natural/scene_edge.h"

namespace rgbdt {

struct DepthEdgeOptions {
  double min_jump_m = 0.4;       ///< in range, from the nearer surface to what lies behind it
  double min_jump_ratio = 0.04;  ///< of the nearer range, added to that
  double min_range_m = 0.5;      ///< nearer is the rig itself
  double max_range_m = 60;
};

/// Where the middle of a round beam lies that is covered to this share (0 to 1) by a surface with a
/// straight rim: in half-widths of the beam, beyond the rim. share = (acos d - d sqrt(1 - d^2)) /
/// pi.
double BeyondRim(double share);

/// The depth edges of a sweep (Levinson and Thrun 2013, section III: the nearer side is kept), in
/// both directions of the scan. Only those whose rim runs on over some beams (rims.h): leaves,
/// wires and single stray points have none that an image could show as an edge. The order is the
/// grid's.
std::vector<SceneEdge> FindDepthEdges(const RangeGrid& grid, const DepthEdgeOptions& options = {});

}  // namespace rgbdt
