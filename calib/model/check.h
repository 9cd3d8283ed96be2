#pragma once

#include <string>

namespace rgbdt {

/// What the Check() of options is made of. Each throws InputError that names the options' owner,
/// the field, its value and what is expected instead.
class OptionCheck {
 public:
  /// `owner`: whose options these are, "terrain".
  constexpr explicit OptionCheck(const char* owner) : owner_(owner) {}

  void Require(bool good, const std::string& field, double value,
               const std::string& expected) const;
  /// Finite and more than zero.
  void Positive(double value, const std::string& field) const;
  /// Finite and not less than zero.
  void NotNegative(double value, const std::string& field) const;
  void AtLeast(int value, int least, const std::string& field) const;
  void Between(double value, double low, double high, const std::string& field) const;

 private:
  const char* owner_;
};

}  // namespace rgbdt
