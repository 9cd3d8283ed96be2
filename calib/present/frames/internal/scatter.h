#pragma once

#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

namespace rgbdt {

/// An order of 0 ... count - 1 whose every beginning is spread evenly over all of them: steps of
/// the golden section of `count`, which no number of beams or rings divides for long.
class Scatter {
 public:
  explicit Scatter(std::uint64_t count) : count_(count) {
    constexpr double kGolden = 0.61803398874989485;
    step_ = static_cast<std::uint64_t>(std::llround(kGolden * static_cast<double>(count)));
    while (std::gcd(step_, count_) > 1) ++step_;
    place_step_ = InverseOf(static_cast<std::int64_t>(step_));
  }

  /// Which one comes after `index`; the first one is 0.
  std::uint64_t Next(std::uint64_t index) const { return Wrapped(index + step_); }

  /// The place in that order of `index` + 1, where `index` has `place`; that of 0 is 0.
  std::uint64_t NextPlace(std::uint64_t place) const { return Wrapped(place + place_step_); }

 private:
  std::uint64_t Wrapped(std::uint64_t number) const {
    return number >= count_ ? number - count_ : number;
  }

  // x with x * number = 1 modulo `count_`; Euclid's algorithm.
  std::uint64_t InverseOf(std::int64_t number) const {
    const auto count = static_cast<std::int64_t>(count_);
    std::int64_t rest = count, other = number, x = 0, next = 1;
    while (other != 0) {
      const std::int64_t times = rest / other;
      rest = std::exchange(other, rest - times * other);
      x = std::exchange(next, x - times * next);
    }
    return static_cast<std::uint64_t>(x < 0 ? x + count : x);
  }

  std::uint64_t count_, step_, place_step_;
};

}  // namespace rgbdt
