#pragma once

#include <cstdio>
#include <filesystem>
#include <string>

#include "calib/terrain/terrain.h"

namespace rgbdt {

/// Writes `json` and `picture` of a terrain, and tells how much of it can be driven on. `frame` and
/// `input`: of the cloud that it was found in, and what that is called in `json`. Throws InputError
/// for what cannot be written.
void WriteTerrain(const Terrain& terrain, const TerrainOptions& options, const std::string& frame,
                  const std::string& input, const std::filesystem::path& json,
                  const std::filesystem::path& picture, std::FILE* told);

}  // namespace rgbdt
