#pragma once

// The vertices of a PLY file as a table of numbers.

#include <string>
#include <string_view>
#include <vector>

#include "calib/files/points/internal/record_table.h"

namespace rgbdt::ply {

struct File {
  std::vector<std::string> comments;  ///< without the word itself
  records::Table table;               ///< the element vertex
};

/// Whether a file that begins with `head` can be a sweep, as pcd::CheckSweepHead.
void CheckSweepHead(std::string_view head, const std::string& where);

/// Reads ascii and binary_little_endian. The vertices must be the first element; what follows them
/// (faces) is not read. The bytes must outlive what is returned. Throws InputError naming `where`,
/// the line or byte and what was expected; allocates only in proportion to the bytes that there
/// are.
File Parse(std::string_view bytes, const std::string& where);

}  // namespace rgbdt::ply
