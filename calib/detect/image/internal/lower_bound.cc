#include "calib/detect/image/internal/lower_bound.h"

#include <algorithm>
#include <cmath>

namespace rgbdt {
namespace {

constexpr double kFar = -5;                          // Phi itself is inexact below
constexpr double kLogRootTwoPi = 0.918938533204673;  // ln(sqrt(2 pi))

// phi(z) / Phi(z) for z below kFar, by Laplace's continued fraction.
double RatioFar(double z) {
  double tail = -z;
  for (int k = 8; k > 0; --k) tail = -z + k / tail;
  return tail;
}

}  // namespace

LowerBound::LowerBound(double z) {
  const double log_density = -0.5 * z * z - kLogRootTwoPi;
  if (z < kFar) {
    residual = RatioFar(z);
    cost = std::log(residual) - log_density;
  } else {
    const double below = 0.5 * std::erfc(-0.7071067811865476 * z);
    residual = std::exp(log_density) / below;
    cost = -std::log(below);
  }
  weight = std::clamp(residual * (residual + z), 0.0, 1.0);
}

}  // namespace rgbdt
