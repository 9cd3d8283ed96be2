#pragma once

// The bytes of a LAS 1.4 file before its points.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "calib/model/time.h"

namespace rgbdt::las {

/// A number of a point for which LAS has no field.
struct ExtraDimension {
  enum class Type : std::uint8_t { kUint32 = 5, kFloat = 9 };  ///< the specification's numbers
  std::string name, description;                               ///< 31 characters at most
  Type type;
};

/// A variable length record.
struct Record {
  std::string user;  ///< 16 characters at most
  std::uint16_t id = 0;
  std::string description, data;  ///< 32 characters and 65535 bytes at most
};

struct Layout {
  std::uint64_t points = 0;
  Eigen::Array3d least, most;  ///< [m], of the points as they are written
  double step_m = 0;
  std::vector<ExtraDimension> extra;  ///< in the order of the record
  std::string text;                   ///< for a person
  bool compressed = false;            ///< points as LAZ has them
  std::vector<Record> first, last;    ///< before and behind the records of the above
  std::uint64_t extended_at = 0;      ///< where the one extended record begins; 0: there is none

  std::size_t RecordBytes() const;  ///< of a point
};

// Numbers little-endian, as this machine is.
template <typename T>
void Put(T value, std::string* out) {
  out->append(reinterpret_cast<const char*>(&value), sizeof value);
}
/// Cut, or filled up with zeros.
void PutText(const std::string& text, std::size_t size, std::string* out);

/// Public header and variable length records.
std::string Head(const Layout& layout);

/// Seconds of adjusted standard GPS time (since 6 January 1980, less 1e9).
double GpsTime(Utime utime);

}  // namespace rgbdt::las
