#include "calib/model/check.h"

#include <cmath>

#include "calib/model/errors.h"

namespace rgbdt {

void OptionCheck::Require(bool good, const std::string& field, double value,
                          const std::string& expected) const {
  if (good) return;
  throw InputError(std::string(owner_) + ": " + field + " is " + std::to_string(value) +
                   "; expected " + expected);
}

void OptionCheck::Positive(double value, const std::string& field) const {
  Require(std::isfinite(value) && value > 0, field, value, "a positive number");
}

void OptionCheck::NotNegative(double value, const std::string& field) const {
  Require(std::isfinite(value) && value >= 0, field, value, "zero or a positive number");
}

void OptionCheck::AtLeast(int value, int least, const std::string& field) const {
  Require(value >= least, field, value, std::to_string(least) + " or more");
}

void OptionCheck::Between(double value, double low, double high, const std::string& field) const {
  Require(value >= low && value <= high, field, value,
          std::to_string(low) + " to " + std::to_string(high));
}

}  // namespace rgbdt
