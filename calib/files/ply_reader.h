#pragma once

// Inside calib/files only: a PLY file's points as a table of numbers.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace rgbdt::ply {

struct Property {
  std::string name;
  std::string type;        ///< "float", "uchar", ...: by its old or new name, as the file says
  std::size_t size = 0;    ///< bytes
  std::size_t offset = 0;  ///< of its bytes in a record
};

/// The element `vertex` of a PLY file (Turk 1994), ascii or binary_little_endian. What comes after
/// it in the file is not read. The bytes parsed must outlive the table.
class Table {
 public:
  /// Throws InputError naming `where`: no PLY file, big-endian, list properties in or before the
  /// vertices, no vertices, cut short. Allocates only in proportion to the bytes that there are: a
  /// header may claim anything.
  Table(std::string_view bytes, std::string where);

  std::size_t size() const { return count_; }
  /// The header's comments, without the word.
  const std::vector<std::string>& comments() const { return comments_; }
  bool Has(const std::string& property) const { return Find(property) != nullptr; }
  /// The property of every point. Every integer up to 2^53 and every float is exact. Throws
  /// InputError where there is none of this name.
  std::vector<double> Column(const std::string& property) const;

 private:
  const Property* Find(const std::string& name) const;
  void ReadHeader(std::string_view bytes);
  void ReadElement(const std::vector<std::string_view>& words);
  void ReadProperty(const std::vector<std::string_view>& words);
  void ReadAscii(std::string_view data);
  [[noreturn]] void Fail(const std::string& what) const;

  std::string where_;
  std::string format_;
  std::vector<std::string> comments_;
  std::vector<Property> properties_;  ///< of the vertices
  std::size_t count_ = 0, stride_ = 0;
  std::size_t before_bytes_ = 0, before_records_ = 0;  ///< of elements ahead of the vertices
  std::size_t element_count_ = 0;                      ///< of the element being read
  enum class Section { kBefore, kVertex, kAfter } section_ = Section::kBefore;
  std::size_t data_begin_ = 0;
  std::string_view binary_;
  std::vector<std::vector<double>> ascii_;  ///< by property
};

}  // namespace rgbdt::ply
