#pragma once

#include <cstdint>

namespace rgbdt::testing {

/// Watches this process's heap: malloc's and what is built on it (new, OpenCV's pictures). It
/// counts what is asked for, so it tells the same with a sanitizer, which keeps what is freed for a
/// while.
class PeakMemory {
 public:
  /// Begins to watch. Only one at a time.
  PeakMemory();

  /// [bytes] The most that has been in use at once since, above what was in use at the beginning.
  std::int64_t Grown() const;

 private:
  std::int64_t before_;
};

}  // namespace rgbdt::testing
