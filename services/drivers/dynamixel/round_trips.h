#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace rgbdt {

/// Tells unusual round trips [us] from the others. Usual is the lower quartile of the last kKept:
/// what comes between (the scheduler, a busy USB bus) only ever makes a trip longer, and when the
/// line itself becomes slower, that is usual soon. One that is much shorter ended with the late
/// answer to an earlier request.
class RoundTrips {
 public:
  static constexpr std::size_t kKept = 64;
  static constexpr double kSlackUs = 200;  ///< adds half of it to a reading's error, at most

  /// Adds one; true where it is longer or shorter than usual by more than the slack.
  bool IsUnusual(double us) {
    kept_[count_++ % kKept] = us;
    return std::abs(us - usual()) > kSlackUs;
  }

  /// 0 before the first.
  double usual() const {
    const std::size_t size = std::min(count_, kKept);
    if (size == 0) return 0;
    std::array<double, kKept> sorted = kept_;
    const auto quartile = sorted.begin() + size / 4;
    std::nth_element(sorted.begin(), quartile, sorted.begin() + size);
    return *quartile;
  }

 private:
  std::array<double, kKept> kept_{};
  std::size_t count_ = 0;
};

}  // namespace rgbdt
