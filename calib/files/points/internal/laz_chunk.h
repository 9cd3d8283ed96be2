#pragma once

#include <string>
#include <string_view>

namespace rgbdt::laz {

/// Fields of point record format 7 (LAS 1.4 R15, table 17) by their first byte.
inline constexpr std::size_t kIntensityAt = 12, kFlagsAt = 14, kGpsTimeAt = 22, kColourAt = 30,
                             kExtraAt = 36;

/// A chunk of a LAZ file (LASzip's compressor 3: items POINT14, RGB14 and BYTE14 of version 3):
/// the first point as it is, the number of points, the sizes of the layers, the layers. `records`
/// are at least one, of format 7 with extra bytes, all of return 1 of 1 and with the same flags,
/// class, user's byte, scan angle and source; throws std::invalid_argument otherwise.
std::string EncodeChunk(std::string_view records, std::size_t record_bytes);

}  // namespace rgbdt::laz
