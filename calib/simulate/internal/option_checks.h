#pragma once

#include <cmath>
#include <string>

#include "calib/model/errors.h"

namespace rgbdt::simulate {

/// What the Check() of options is made of: each throws InputError naming the field and its value.
inline void Require(bool good, const std::string& field, double value,
                    const std::string& expected) {
  if (good) return;
  throw InputError("simulator: " + field + " is " + std::to_string(value) + "; expected " +
                   expected);
}

inline void Positive(double value, const std::string& field) {
  Require(std::isfinite(value) && value > 0, field, value, "a positive number");
}

inline void NotNegative(double value, const std::string& field) {
  Require(std::isfinite(value) && value >= 0, field, value, "zero or a positive number");
}

inline void Between(double value, double low, double high, const std::string& field) {
  Require(value >= low && value <= high, field, value,
          std::to_string(low) + " to " + std::to_string(high));
}

}  // namespace rgbdt::simulate
