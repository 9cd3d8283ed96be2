#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "calib/model/image.h"

namespace rgbdt {

/// A radiometry as a table over all 16-bit counts: a temperature in a few nanoseconds, and how
/// exact it is.
class TemperatureTable {
 public:
  struct Temperature {
    float kelvin = 0, sigma_k = 0;  ///< NaN: none, or unknown
  };

  /// `netd_k`: noise of one pixel at 300 K, as data sheets have it; 0: unknown.
  TemperatureTable(const Radiometry& radiometry, double netd_k);

  /// Counts may be between whole ones: of a bilinear sample.
  Temperature At(float counts) const {
    return table_.empty() ? Temperature{kNone, kNone} : Between(table_.data(), counts);
  }

  /// The same of many.
  void At(const float* counts, std::size_t count, float* kelvin, float* sigma_k) const;

  bool IsFor(const Radiometry& radiometry) const;

 private:
  static constexpr std::size_t kCounts = 65536;
  static constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

  // Without branches, so that a loop of it is vectorised.
  static Temperature Between(const Temperature* table, float counts) {
    const bool in = (counts >= 0) & (counts <= static_cast<float>(kCounts - 1));
    const float inside = in ? counts : 0;
    const auto low = static_cast<std::int32_t>(inside);
    const float share = inside - static_cast<float>(low);
    const std::int32_t high = low + (share > 0 ? 1 : 0);  // the next one may be none
    const Temperature a = table[low];
    const Temperature b = table[high];
    const float kelvin = a.kelvin + share * (b.kelvin - a.kelvin);
    const float sigma_k = a.sigma_k + share * (b.sigma_k - a.sigma_k);
    return {in ? kelvin : kNone, in ? sigma_k : kNone};
  }
  static void AtSimd(const Temperature* table, const float* counts, std::size_t count,
                     float* kelvin, float* sigma_k);

  Radiometry radiometry_;
  std::vector<Temperature> table_;  // empty: counts say no temperature
};

}  // namespace rgbdt
