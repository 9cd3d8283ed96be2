#pragma once

#include <cstdint>

namespace rgbdt {

/// Microseconds since 1970-01-01 UTC of the sensors' clock. In simulation: simulated time.
/// The only time that data carries; nothing in data comes from the wall clock.
using Utime = std::int64_t;

inline constexpr Utime kMicrosecondsPerSecond = 1'000'000;

inline constexpr double ToSeconds(Utime duration) {
  return static_cast<double>(duration) / kMicrosecondsPerSecond;
}

inline constexpr Utime FromSeconds(double seconds) {
  return static_cast<Utime>(seconds * kMicrosecondsPerSecond + (seconds < 0 ? -0.5 : 0.5));
}

}  // namespace rgbdt
