#pragma once

// The fields of a container's records.

#include <string>

#include "calib/model/errors.h"
#include "services/bags/internal/bag_file.h"

namespace rgbdt::bags {

/// Takes fields off the front of a record. Throws InputError where it ends too early.
class Fields {
 public:
  Fields(const std::uint8_t* bytes, std::size_t size) : at_(bytes), end_(bytes + size) {}

  std::size_t left() const { return static_cast<std::size_t>(end_ - at_); }
  const std::uint8_t* Bytes(std::uint64_t count) {
    if (count > left()) {
      throw InputError("a record ends " + std::to_string(count - left()) + " bytes too early");
    }
    const std::uint8_t* begin = at_;
    at_ += count;
    return begin;
  }
  template <typename T>
  T Number() {
    return LittleEndian<T>(Bytes(sizeof(T)));
  }
  /// Its length is a number of 32 bits before it.
  std::string Text() {
    const auto length = Number<std::uint32_t>();
    const std::uint8_t* begin = Bytes(length);
    return {begin, begin + length};
  }

 private:
  const std::uint8_t* at_;
  const std::uint8_t* end_;
};

}  // namespace rgbdt::bags
