#pragma once

#include <cstdint>
#include <string>

#include "calib/model/time.h"

namespace rgbdt::simulate {

/// Noise without state: number `index` of the stream that (seed, utime, sensor) names. A simulator
/// that starts again, or takes a frame twice, finds the same noise.
class Noise {
 public:
  Noise(std::uint64_t seed, Utime utime, const std::string& sensor);

  /// 64 evenly distributed bits.
  std::uint64_t Bits(std::uint64_t index) const { return Mix(key_ + index * kGolden); }
  /// Evenly distributed, 0 < value < 1.
  double Uniform(std::uint64_t index) const;
  double Uniform(std::uint64_t index, double low, double high) const {
    return low + (high - low) * Uniform(index);
  }
  /// Standard normal.
  double Normal(std::uint64_t index) const;
  /// Two standard normals from one hash; 32 bits each, so they end at 6.2 sigma.
  void NormalPair(std::uint64_t index, float* first, float* second) const;

  /// The finaliser of splitmix64 (Steele, Lea and Flood, 2014).
  static std::uint64_t Mix(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
    return x ^ (x >> 31);
  }

 private:
  static constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15ULL;
  std::uint64_t key_;
};

/// Inverse of the normal distribution, 0 < p < 1; relative error below 1.2e-9 (P. Acklam, 2003).
double InverseNormal(double p);

}  // namespace rgbdt::simulate
