#pragma once

#include <array>
#include <vector>

#include "calib/detect/cloud/range_grid.h"
#include "calib/methods/natural/scene_edge.h"

namespace rgbdt {

/// From a beam to its neighbours.
struct ScanStep {
  int row, column;
};
inline constexpr std::array<ScanStep, 4> kScanSteps{{{0, 1}, {0, -1}, {1, 0}, {-1, 0}}};

/// An edge, the cell of its nearer (brighter) side, and in which of kScanSteps it was met.
struct FoundEdge {
  SceneEdge edge;
  int row, column;
  int step;
};

/// How the rims run, by the edges beside each, which edges belong together, and their mean reach.
/// Without edges whose neighbours form no rim: that have fewer than four of them, or whose
/// neighbours lie aside of it by more than 0.3 of how far they lie along it.
std::vector<SceneEdge> WithRims(const RangeGrid& grid, const std::vector<FoundEdge>& found);

}  // namespace rgbdt
