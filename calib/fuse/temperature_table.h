#pragma once

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
  Temperature At(float counts) const;

  bool IsFor(const Radiometry& radiometry) const;

 private:
  Radiometry radiometry_;
  std::vector<Temperature> table_;  // empty: counts say no temperature
};

}  // namespace rgbdt
