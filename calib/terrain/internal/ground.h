#pragma once

// Inside calib/terrain only: which cells show the ground.

#include <cstdint>
#include <vector>

#include "calib/terrain/internal/cells.h"

namespace rgbdt::terrain {

/// The steepest ground that is followed [rad]: what the vehicle climbs and some more.
double GroundSlope(const TerrainOptions& options);

/// How high a cell's lowest points lie [m], a stray below left out; NaN: too few points.
std::vector<float> LowestHeights(const Cells& cells, const TerrainGrid& grid,
                                 const TerrainOptions& options);

/// 1 for the cells whose lowest points are ground: README.md, "Ground".
std::vector<std::uint8_t> FindGround(const std::vector<float>& lowest, const TerrainGrid& grid,
                                     const TerrainOptions& options);

/// For each cell the nearest one that is marked, itself where it is; -1: none is.
struct Nearest {
  std::vector<std::int64_t> cell;
  std::vector<float> distance_m;  ///< middle to middle, to some percent
};
Nearest NearestMarked(const std::vector<std::uint8_t>& marked, const TerrainGrid& grid);

}  // namespace rgbdt::terrain
