#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace rgbdt {

/// What an edge of the cloud is, and between which beams it was met.
enum class SceneEdgeKind { kDepthWithinRow, kDepthAcrossRows, kReflectivity };
inline constexpr int kSceneEdgeKinds = 3;
/// Depth, and reflectivity: not as many of one as of the other are shown by an image.
inline constexpr std::size_t kEdgeSources = 2;
constexpr std::size_t SourceOf(SceneEdgeKind kind) {
  return kind == SceneEdgeKind::kReflectivity ? 1 : 0;
}

/// What a LIDAR shows that a camera may show as an edge: where a nearer surface ends before what
/// lies behind it (its rim), or where a surface's reflectivity changes, which is called its rim
/// here, too, and the brighter side the nearer one. LIDAR frame, metres.
struct SceneEdge {
  /// Between the last beam on this side of the rim and the first one past it: of depth halfway, at
  /// the nearer surface's range.
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  /// From there outwards, to the first beam past it: the rim lies within +-across, evenly.
  Eigen::Vector3d across = Eigen::Vector3d::Zero();
  Eigen::Vector3d along =
      Eigen::Vector3d::Zero();  ///< unit, along the rim, as the neighbouring edges have it
  /// Of depth: how far beyond the rim, in half-widths of the beam (-1 to 1), a beam's middle may
  /// point and still return the nearer surface: where it meets both, the one that sends more light
  /// back. On average over the rim.
  double reach = 0;
  /// Column of the nearer beam of edges within a row, row of those across rows: edges of one rim in
  /// the same place have the same error within +-across.
  int place = 0;
  int thing = 0;  ///< edges that are connected have the same number
  int rim = 0;    ///< of these, edges that were met in one direction of the scan, likewise
  SceneEdgeKind kind = SceneEdgeKind::kDepthWithinRow;
};

}  // namespace rgbdt
