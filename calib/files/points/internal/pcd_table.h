#pragma once

// A PCD file as a table of numbers.

#include <string>
#include <string_view>
#include <vector>

#include "calib/files/points/internal/record_table.h"

namespace rgbdt::pcd {

struct Header {
  std::vector<records::Field> fields;
  std::size_t width = 0, height = 0;
  std::string data;                   ///< ascii, binary or binary_compressed
  std::size_t data_begin = 0;         ///< where the points begin in the file
  std::vector<std::string> comments;  ///< lines that begin with '#', without it

  std::size_t points() const { return width * height; }
};

struct File {
  Header header;
  records::Table table;
};

/// Whether a file that begins with `head` can be a sweep: throws InputError naming `where` for a
/// header that is none or claims more points than kMostSweepPoints. For before it is read.
void CheckSweepHead(std::string_view head, const std::string& where);

/// The bytes must outlive what is returned. Throws InputError naming `where`, and the line or byte;
/// allocates only in proportion to the bytes that there are: a header may claim anything.
File Parse(std::string_view bytes, const std::string& where);

}  // namespace rgbdt::pcd
