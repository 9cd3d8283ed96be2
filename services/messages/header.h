#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "calib/model/time.h"

namespace rgbdt {

/// What every type begins with, behind its fingerprint. Nothing of it is checked.
struct Header {
  Utime utime = 0;
  std::int64_t seq = 0;
};

inline constexpr std::size_t kHeaderBytes = 24;

/// Absent: the bytes are too few.
inline std::optional<Header> HeaderOf(const std::uint8_t* data, std::size_t size) {
  if (size < kHeaderBytes) return std::nullopt;
  const auto int64_at = [data](std::size_t begin) {
    std::uint64_t value = 0;
    for (std::size_t i = begin; i < begin + 8; ++i) value = value << 8 | data[i];
    return static_cast<std::int64_t>(value);
  };
  return Header{int64_at(8), int64_at(16)};
}

}  // namespace rgbdt
