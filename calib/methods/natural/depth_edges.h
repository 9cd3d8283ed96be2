#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/model/cloud.h"

namespace rgbdt {

/// Between which beams a depth edge was met.
enum class DepthEdgeKind { kWithinRow, kAcrossRows };
inline constexpr int kDepthEdgeKinds = 2;

/// Where a nearer surface ends before what lies behind it, between two neighbouring beams. LIDAR
/// frame, metres.
struct DepthEdge {
  /// Halfway between the last beam on the nearer surface and the first one past it, at the nearer
  /// surface's range.
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  /// From there to the first beam past it: the rim lies within +-across, evenly.
  Eigen::Vector3d across = Eigen::Vector3d::Zero();
  Eigen::Vector3d along =
      Eigen::Vector3d::Zero();  ///< unit, along the rim, as the neighbouring edges have it
  /// How far beyond the rim, in half-widths of the beam (-1 to 1), a beam's middle may point and
  /// still return the nearer surface: where it meets both, the one that sends more light back. On
  /// average over the rim.
  double reach = 0;
  /// Column of the nearer beam of edges within a row, row of those across rows: edges of one rim in
  /// the same place have the same error within +-across.
  int place = 0;
  int thing = 0;  ///< edges that are connected have the same number
  int rim = 0;    ///< of these, edges that were met in one direction of the scan, likewise
  DepthEdgeKind kind = DepthEdgeKind::kWithinRow;
};

struct DepthEdgeOptions {
  double min_jump_m = 0.4;       ///< in range, from the nearer surface to what lies behind it
  double min_jump_ratio = 0.04;  ///< of the nearer range, added to that
  double min_range_m = 0.5;      ///< nearer is the rig itself
  double max_range_m = 60;
  int min_neighbours = 4;      ///< edges that tell how the rim runs
  double max_roughness = 0.3;  ///< of the neighbours' spread: aside of the rim over along it
};

/// Where the middle of a round beam lies that is covered to this share (0 to 1) by a surface with a
/// straight rim: in half-widths of the beam, beyond the rim. share = (acos d - d sqrt(1 - d^2)) /
/// pi.
double BeyondRim(double share);

/// The depth edges of a sweep (Levinson and Thrun 2013, section III: the nearer side is kept), in
/// both directions of the scan. Only those whose rim runs on over some beams: leaves, wires and
/// single stray points have none that an image could show as an edge. The order is the grid's.
std::vector<DepthEdge> FindDepthEdges(const Cloud& cloud, const DepthEdgeOptions& options = {});

}  // namespace rgbdt
