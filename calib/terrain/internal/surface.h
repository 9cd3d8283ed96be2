#pragma once

// Inside calib/terrain only: the ground's plane in each cell, and what stands on it.

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <vector>

#include "calib/terrain/internal/cells.h"

namespace rgbdt::terrain {

/// A cell's ground: z = height + gradient . (x, y) from the cell's middle. NaN: not known.
struct Patch {
  float height = 0;                      ///< of its own points [m]
  float gradient_x = 0, gradient_y = 0;  ///< of it and its surroundings
  bool known() const;                    ///< height and gradient are numbers
  float At(float x, float y) const { return height + gradient_x * x + gradient_y * y; }
};

/// The patches of cells marked as ground; of the others, and where too little is seen, unknown.
std::vector<Patch> FitPatches(const Cells& cells, const std::vector<float>& lowest,
                              const std::vector<std::uint8_t>& ground, const TerrainGrid& grid,
                              const TerrainOptions& options);

/// As a share of a cell's edge: so near the rim, a range's noise may have moved a point here, or,
/// if it is large, even to there.
constexpr float kBorder = 0.1F, kWideBorder = 0.3F;

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

/// What lies on and over a patch.
struct Layers {
  std::int64_t on_ground = 0;       ///< points (by their count) on it
  double roughness_m = 0;           ///< RMS of those about the patch
  std::int64_t standing = 0;        ///< points above `step_m` and below the vehicle's height
  std::int64_t inside = 0;          ///< of those, not within kBorder of the cell's rim
  double highest_m = 0;             ///< of those below the vehicle's height, a stray left out
  std::int64_t overhead = 0;        ///< points above the vehicle's height, below the headroom
  double temperature_k = kNothing;  ///< mean of all below the vehicle's height; NaN: unknown
};

/// `aside`: from the middle of the patch's cell to that of the points' [m].
Layers SortIntoLayers(const Span& points, const Patch& patch, const Eigen::Vector2f& aside,
                      double step_m, const TerrainOptions& options);

}  // namespace rgbdt::terrain
