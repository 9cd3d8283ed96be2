#pragma once

#include <filesystem>
#include <string>

#include "calib/model/map_cloud.h"

namespace rgbdt {

/// Writes a map as a binary little-endian PLY, atomically: x y z [m] (float: exact to 1 mm up to 8
/// km from the origin), red green blue, temperature_k [K] (NaN: unknown), count, last_seen [us,
/// UTC] (double). Comments name units, `frame` and `voxel_m`. Throws InputError for a map that is
/// empty or whose vectors differ in length, and where the file cannot be written.
void WriteMapPly(const std::filesystem::path& path, const MapCloud& map);

/// Reads it back: the same map. Throws InputError naming the file where it is no map (rgbdt map
/// writes one), damaged or cut short.
MapCloud ReadMapPly(const std::filesystem::path& path);

/// The same from bytes; `where` stands for the file in error messages.
MapCloud ParseMapPly(const std::string& bytes, const std::string& where);

/// Whether bytes are a map's, by how they begin; whatever follows.
bool IsMapPly(const std::string& bytes);

/// A map, a fused cloud or any other PLY or PCD with x y z [m] (ReadFused), by what the file begins
/// with. What is not a map gets the frame "lidar" and voxel_m 0, each point counting once. Throws
/// InputError naming the file where it cannot be read or has no point.
MapCloud ReadMapOrCloud(const std::filesystem::path& path);

}  // namespace rgbdt
