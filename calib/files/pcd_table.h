#pragma once

// Inside calib/files only: a PCD file as a table of numbers.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace rgbdt::pcd {

struct Field {
  std::string name;
  char type = 'F';        ///< I, U or F
  std::size_t size = 4;   ///< bytes of one element
  std::size_t count = 1;  ///< elements a point
};

struct Header {
  std::vector<Field> fields;
  std::size_t width = 0, height = 0;
  std::string data;            ///< ascii, binary or binary_compressed
  std::size_t data_begin = 0;  ///< where the points begin in the file

  std::size_t points() const { return width * height; }
  std::size_t PointBytes() const;
};

/// The file's points. The bytes parsed must outlive the table.
class Table {
 public:
  /// Throws InputError naming `where`. Allocates only in proportion to the bytes that there are:
  /// a header may claim anything.
  Table(std::string_view bytes, std::string where);

  const Header& header() const { return header_; }
  bool Has(const std::string& field) const;
  /// The field's type ('I', 'U' or 'F').
  char TypeOf(const std::string& field) const;
  /// The field's first element of every point. Every integer up to 2^53 and every float is exact.
  std::vector<double> Column(const std::string& name) const;

 private:
  const Field* Find(const std::string& name) const;
  void ReadHeader(std::string_view bytes);
  void ReadAscii(std::string_view data);
  void Unpack(std::string_view data);
  void RequireBytes(std::size_t have) const;
  [[noreturn]] void Fail(const std::string& what) const;

  std::string where_;
  Header header_;
  std::vector<std::vector<double>> ascii_;  ///< by field
  std::string unpacked_;
  std::string_view binary_;
  bool by_field_ = false;  ///< all values of a field lie together (compressed)
};

}  // namespace rgbdt::pcd
