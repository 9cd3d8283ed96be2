#pragma once

// Whole LAZ and COPC files of the records that a LAS file holds.

#include <cstdint>
#include <string>
#include <vector>

#include "calib/files/points/internal/las_layout.h"

namespace rgbdt::laz {

/// The points of a file, compressed in parts that can be read on their own.
struct Chunks {
  std::vector<std::string> bytes;
  std::vector<std::uint32_t> points;
  bool same_size = true;  ///< all but the last have kChunkPoints
};

inline constexpr std::size_t kChunkPoints = 50'000;  // as LASzip has it

/// A file in parts, one after the other. `plain` as for plain LAS.
using Parts = std::vector<std::string>;
Parts LazFile(const las::Layout& plain, const std::string& records);

/// COPC 1.0: nodes of an octree as chunks, coarse ones first, each with an even subsample of what
/// is below it. Within a node the points keep their order. Throws InputError where a chunk
/// takes more than COPC can say (2 GiB).
Parts CopcFile(const las::Layout& plain, const std::string& records);

/// The variable length record that says how points are compressed.
las::Record LaszipRecord(std::size_t record_bytes, bool same_size);

/// Where chunks begin: behind the points, itself coded.
std::string ChunkTable(const Chunks& chunks);

/// What stands before the chunks' first byte: header, records, where the chunk table is.
std::string LazHead(const las::Layout& layout, const Chunks& chunks);

}  // namespace rgbdt::laz
