#pragma once

#include <string>

#include "calib/simulate/internal/noise.h"

namespace rgbdt::simulate {

/// Numbers of one of Noise's streams, one after the other: for what is laid out at random. Two
/// draws never stand among one call's arguments: compilers differ in which comes first.
class Dice {
 public:
  Dice(std::uint64_t seed, std::int64_t number, const std::string& name)
      : noise_(seed, number, name) {}

  double Between(double low, double high) { return noise_.Uniform(next_++, low, high); }
  bool Chance(double share) { return Between(0, 1) < share; }
  int Below(int count) { return static_cast<int>(Between(0, count)); }

 private:
  Noise noise_;
  std::uint64_t next_ = 0;
};

}  // namespace rgbdt::simulate
