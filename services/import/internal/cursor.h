#pragma once

// How ROS lays messages out: fields one after the other, which a function reads that is templated
// over the layout.

#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>

#include "calib/model/errors.h"

namespace rgbdt::ros {

/// What both layouts share. Throws InputError where a message ends too early.
class Cursor {
 public:
  Cursor(const std::uint8_t* bytes, std::size_t size)
      : begin_(bytes), at_(bytes), end_(bytes + size) {}

  std::size_t left() const { return static_cast<std::size_t>(end_ - at_); }
  const std::uint8_t* Bytes(std::size_t count) {
    if (count > left()) {
      throw InputError("ends " + std::to_string(count - left()) + " bytes too early");
    }
    const std::uint8_t* begin = at_;
    at_ += count;
    return begin;
  }

 protected:
  template <typename T>
  static T Load(const std::uint8_t* bytes, bool swap) {
    std::uint8_t ordered[sizeof(T)];
    for (std::size_t i = 0; i < sizeof(T); ++i) ordered[i] = bytes[swap ? sizeof(T) - 1 - i : i];
    T value;
    std::memcpy(&value, ordered, sizeof(T));
    return value;
  }

  const std::uint8_t* begin_;  // what alignment counts from
  const std::uint8_t* at_;
  const std::uint8_t* end_;
};

/// ROS 1: packed, little-endian.
class PackedCursor : public Cursor {
 public:
  static constexpr bool kRos1 = true;
  using Cursor::Cursor;

  template <typename T>
  T Number() {
    return Load<T>(Bytes(sizeof(T)), false);
  }
  std::string Text() {
    const auto length = Number<std::uint32_t>();
    const std::uint8_t* begin = Bytes(length);
    return {begin, begin + length};
  }
};

/// ROS 2: CDR. Each number is aligned to its own size, texts end with a zero that counts.
class CdrCursor : public Cursor {
 public:
  static constexpr bool kRos1 = false;
  CdrCursor(const std::uint8_t* bytes, std::size_t size) : Cursor(bytes, size) {
    const std::uint8_t* head = Bytes(4);
    if (head[0] != 0 || head[1] > 1) {
      throw InputError("is CDR of kind " + std::to_string(256 * head[0] + head[1]) +
                       "; expected 0 or 1, plain CDR");
    }
    swap_ = head[1] == 0;  // big-endian
    begin_ = at_;
  }

  template <typename T>
  T Number() {
    const auto offset = static_cast<std::size_t>(at_ - begin_);
    Bytes((sizeof(T) - offset % sizeof(T)) % sizeof(T));
    return Load<T>(Bytes(sizeof(T)), swap_);
  }
  std::string Text() {
    const auto length = Number<std::uint32_t>();
    const std::uint8_t* begin = Bytes(length);
    return length == 0 ? std::string() : std::string(begin, begin + length - 1);
  }

 private:
  bool swap_ = false;
};

}  // namespace rgbdt::ros
