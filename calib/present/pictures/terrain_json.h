#pragma once

#include <string>

#include "calib/terrain/terrain.h"

namespace rgbdt {

/// terrain.json: frame, limits, sites, and the grid with an array for each measure, row after row
/// from the lowest y on, each row from the lowest x on; null: not known. Metres, degrees, kelvin
/// as the names say. Lists the grid's `states` by number. The same terrain gives the same bytes.
std::string TerrainJson(const Terrain& terrain, const TerrainOptions& options,
                        const std::string& frame, const std::string& input);

}  // namespace rgbdt
