#pragma once

#include <filesystem>
#include <optional>

#include "calib/model/map_cloud.h"
#include "calib/model/rgbdt_cloud.h"

namespace rgbdt {

// LAS 1.4 (ASPRS, R15), point record format 7, as CloudCompare, QGIS and PDAL read it. Coordinates
// are in metres, in steps of kLasStepM; there is no coordinate system, which a text record says,
// with the frame. Colours have 16 bits (257 times the 8 of ours), intensity 0 to 65535, gps_time is
// adjusted standard GPS time [s], leap seconds put in. What LAS has no field for are extra
// dimensions by name: temperature [K], NaN where unknown, and those named below. All throw
// InputError: vectors that differ in length, no point, a point farther than LAS holds at that step
// (214 km), a file that cannot be written.
//
// The ending decides how the same points are written: .copc.laz, .laz, or anything else for plain
// LAS. LAZ (LASzip's layered, chunked compression, version 3) holds the same records, bit for bit,
// in the same order; COPC 1.0 is such a file ordered as an octree, of which a viewer reads the part
// that it shows, from a web server, too. Both are made in memory, some 100 bytes a point beside
// the cloud itself: tens of millions of points, not billions.

inline constexpr double kLasStepM = 1e-4;

enum class LasKind { kPlain, kLaz, kCopc };
/// By a name's ending, in capitals, too: .las, .laz, .copc.laz; nothing for others.
std::optional<LasKind> LasKindOf(const std::filesystem::path& path);

/// Extra dimensions: temperature, temperature_sigma [K], valid (bit i: camera i saw the point; the
/// text record names them).
void WriteLas(const std::filesystem::path& path, const RgbdtCloud& cloud);

/// Extra dimensions: temperature, count (points in the voxel). gps_time: when it was last seen.
void WriteLas(const std::filesystem::path& path, const MapCloud& map);

}  // namespace rgbdt
