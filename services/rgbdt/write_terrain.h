#pragma once

#include <filesystem>
#include <string>

#include "calib/model/map_cloud.h"
#include "calib/terrain/terrain.h"

namespace rgbdt {

/// Finds where a vehicle can drive and land in `cloud`, writes `json` and `picture`, and prints how
/// much of it can be driven on. `input`: what the cloud is called in `json`. Throws InputError as
/// FindTerrain does, and for what cannot be written.
Terrain WriteTerrain(const MapCloud& cloud, const TerrainOptions& options, const std::string& input,
                     const std::filesystem::path& json, const std::filesystem::path& picture);

}  // namespace rgbdt
