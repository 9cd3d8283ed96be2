#pragma once

// The points of a PCD or PLY file as a table of numbers.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace rgbdt::records {

struct Field {
  std::string name;
  char type = 'F';        ///< PCD's: I, U or F
  std::size_t size = 4;   ///< bytes of one element
  std::size_t count = 1;  ///< elements a record
};

/// I and U with 1, 2, 4 or 8 bytes, F with 4 or 8.
bool IsKnown(const Field& field);

/// Where the records of a file lie.
struct Source {
  std::string where;       ///< stands for the file in error messages
  std::string_view bytes;  ///< the whole file; must outlive the table
  std::size_t data_begin;  ///< where the records begin in it
  std::vector<Field> fields;
  std::size_t count;  ///< records that the header promises

  std::size_t RecordBytes() const;
};

/// No file with more records than that is read.
inline constexpr std::size_t kMaxRecords = 200'000'000;

/// Numbers by field and record. Each constructor throws InputError naming the file and where it is
/// cut short or damaged, and allocates only in proportion to the bytes that there are: a header may
/// claim anything.
class Table {
 public:
  /// Words, parted by white space.
  static Table FromAscii(Source source);
  /// Records one after the other, little-endian.
  static Table FromBinary(Source source);
  /// The same, but all values of a field lie together: what DATA binary_compressed unpacks to.
  static Table FromColumns(Source source, std::string unpacked);

  std::size_t size() const { return source_.count; }
  bool Has(const std::string& field) const { return Find(field) != nullptr; }
  /// The field's type ('I', 'U' or 'F').
  char TypeOf(const std::string& field) const { return Find(field)->type; }
  /// The field's first element of every record. Every integer up to 2^53 and every float is exact.
  /// Throws InputError where there is no such field.
  std::vector<double> Column(const std::string& name) const;
  /// The same of four bytes whose bits matter, whatever the type says: PCL calls a packed colour a
  /// float. In ASCII a whole number is meant as such, any other as the float of those bits.
  std::vector<std::uint32_t> Bits(const std::string& name) const;

 private:
  template <typename Take>
  void ForEach(const Field& field, Take take) const;
  explicit Table(Source source) : source_(std::move(source)) {}
  const Field* Find(const std::string& name) const;
  const Field& Get(const std::string& name) const;
  void ParseAscii();
  [[noreturn]] void Fail(const std::string& what) const;

  Source source_;
  std::vector<std::vector<double>> ascii_;  ///< by field
  std::string unpacked_;                    ///< column by column, where that is how they lie
};

/// Takes the next word off the front of `text`; empty at its end.
std::string_view NextWord(std::string_view* text);
std::vector<std::string_view> Words(std::string_view line);

/// The whole word is a number. Not strtod: that one reads "0,5" in some locales.
bool ParseNumber(std::string_view word, double* value);
bool ParseNumber(std::string_view word, std::size_t* value);
bool ParseNumber(std::string_view word, std::int64_t* value);

/// "line 12": the line, counted from 1, that byte `at` of the file lies in.
std::string LineOf(std::string_view bytes, std::size_t at);

}  // namespace rgbdt::records
