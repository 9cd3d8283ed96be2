#include "calib/simulate/internal/noise.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rgbdt::simulate {
namespace {

TEST(Noise, IsAFunctionOfSeedTimeSensorAndIndexOnly) {
  const Noise a(1, 100, "rgb");
  EXPECT_EQ(a.Bits(5), Noise(1, 100, "rgb").Bits(5));
  EXPECT_NE(a.Bits(5), a.Bits(6));
  EXPECT_NE(a.Bits(5), Noise(2, 100, "rgb").Bits(5));
  EXPECT_NE(a.Bits(5), Noise(1, 101, "rgb").Bits(5));
  EXPECT_NE(a.Bits(5), Noise(1, 100, "thermal").Bits(5));
}

TEST(Noise, InverseNormalInvertsTheDistribution) {
  for (double x = -6; x <= 6; x += 0.125) {
    const double p = 0.5 * std::erfc(-x / std::sqrt(2.0));
    EXPECT_NEAR(InverseNormal(p), x, 1e-7) << "x = " << x;
  }
}

TEST(Noise, NormalsHaveUnitVarianceAndAreUncorrelated) {
  const Noise noise(7, 123456789, "lidar");
  constexpr int kCount = 200000;
  double sum = 0, squares = 0, neighbours = 0, pair = 0, last = 0;
  for (int i = 0; i < kCount; ++i) {
    const double x = noise.Normal(static_cast<std::uint64_t>(i));
    sum += x;
    squares += x * x;
    neighbours += x * last;
    last = x;
    float a = 0, b = 0;
    noise.NormalPair(static_cast<std::uint64_t>(i), &a, &b);
    pair += a * b;
  }
  EXPECT_NEAR(sum / kCount, 0, 0.01);
  EXPECT_NEAR(squares / kCount, 1, 0.02);
  EXPECT_NEAR(neighbours / kCount, 0, 0.01);
  EXPECT_NEAR(pair / kCount, 0, 0.01);
}

}  // namespace
}  // namespace rgbdt::simulate
