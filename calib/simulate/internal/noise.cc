#include "calib/simulate/internal/noise.h"

#include <cmath>

namespace rgbdt::simulate {
namespace {

double Tail(double q) {
  return (((((-7.784894002430293e-03 * q - 3.223964580411365e-01) * q - 2.400758277161838e+00) * q -
            2.549732539343734e+00) *
               q +
           4.374664141464968e+00) *
              q +
          2.938163982698783e+00) /
         ((((7.784695709041462e-03 * q + 3.224671290700398e-01) * q + 2.445134137142996e+00) * q +
           3.754408661907416e+00) *
              q +
          1.0);
}

double Centre(double q) {
  const double r = q * q;
  return (((((-3.969683028665376e+01 * r + 2.209460984245205e+02) * r - 2.759285104469687e+02) * r +
            1.383577518672690e+02) *
               r -
           3.066479806614716e+01) *
              r +
          2.506628277459239e+00) *
         q /
         (((((-5.447609879822406e+01 * r + 1.615858368580409e+02) * r - 1.556989798598866e+02) * r +
            6.680131188771972e+01) *
               r -
           1.328068155288572e+01) *
              r +
          1.0);
}

}  // namespace

Noise::Noise(std::uint64_t seed, Utime utime, const std::string& sensor) {
  std::uint64_t name = 0xcbf29ce484222325ULL;  // FNV-1a
  for (const char c : sensor) name = (name ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  key_ = Mix(seed + kGolden);
  key_ = Mix((key_ ^ static_cast<std::uint64_t>(utime)) + kGolden);
  key_ = Mix((key_ ^ name) + kGolden);
}

double Noise::Uniform(std::uint64_t index) const {
  return (static_cast<double>(Bits(index) >> 12) + 0.5) * 0x1p-52;
}

double Noise::Normal(std::uint64_t index) const { return InverseNormal(Uniform(index)); }

void Noise::NormalPair(std::uint64_t index, float* first, float* second) const {
  const std::uint64_t bits = Bits(index);
  *first = static_cast<float>(InverseNormal((static_cast<double>(bits >> 32) + 0.5) * 0x1p-32));
  *second =
      static_cast<float>(InverseNormal((static_cast<double>(bits & 0xffffffffU) + 0.5) * 0x1p-32));
}

double InverseNormal(double p) {
  constexpr double kLow = 0.02425;
  if (p < kLow) return Tail(std::sqrt(-2 * std::log(p)));
  if (p > 1 - kLow) return -Tail(std::sqrt(-2 * std::log(1 - p)));
  return Centre(p - 0.5);
}

}  // namespace rgbdt::simulate
