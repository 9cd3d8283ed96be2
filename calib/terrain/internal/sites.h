#pragma once

// Inside calib/terrain only.

#include <vector>

#include "calib/terrain/terrain.h"

namespace rgbdt::terrain {

/// Landing sites on a grid whose states are known, best first: README.md, "Landing sites".
std::vector<LandingSite> FindSites(const TerrainGrid& grid, const TerrainOptions& options);

}  // namespace rgbdt::terrain
