#include "calib/odometry/comes_back.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace rgbdt {
namespace {

using Way = std::vector<Eigen::Vector3d>;

// What it is to say, by looking at each pair of places.
bool ByAllPairs(const Way& places) {
  Way kept;
  std::vector<double> ways;
  double way = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (i > 0) way += (places[i] - places[i - 1]).norm();
    if (!ways.empty() && way - ways.back() < 1) continue;
    for (std::size_t k = 0; k < kept.size() && way - ways[k] > 50; ++k) {
      if ((kept[k] - places[i]).norm() < 10) return true;
    }
    kept.push_back(places[i]);
    ways.push_back(way);
  }
  return false;
}

TEST(ComesBack, AsAllPairsSayOfWaysByChance) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  int back = 0;
  constexpr int kWays = 400;
  for (int trial = 0; trial < kWays; ++trial) {
    Way places{{1e3 * normal(random), 1e3 * normal(random), 0}};
    const double bend = 0.05 * normal(random);
    double heading = normal(random);
    for (int i = 0; i < 300; ++i) {
      heading += bend + 0.1 * normal(random);
      const double step = std::abs(normal(random));
      places.push_back(places.back() + step * Eigen::Vector3d(std::cos(heading), std::sin(heading),
                                                              0.1 * normal(random)));
    }
    const bool expected = ByAllPairs(places);
    back += expected ? 1 : 0;
    EXPECT_EQ(ComesBack(places), expected) << "trial " << trial;
  }
  EXPECT_GT(back, kWays / 10);
  EXPECT_LT(back, 9 * kWays / 10);
}

// Out along x and back beside it, across the bounds of cells.
TEST(ComesBack, OnlyWithinTenMetres) {
  for (const double beside : {-10.001, -9.999, 9.999, 10.001}) {
    for (const double at : {0.0, 3.3, -9.9999}) {
      Way places;
      for (int x = 0; x <= 100; ++x) places.emplace_back(x, at, 0);
      for (int x = 100; x >= 0; --x) places.emplace_back(x, at + beside, 0);
      EXPECT_EQ(ComesBack(places), std::abs(beside) < 10) << beside << " at " << at;
    }
  }
}

TEST(ComesBack, NotWhereItStandsOrHasNoEnd) {
  EXPECT_FALSE(ComesBack({}));
  EXPECT_FALSE(ComesBack(Way(1000, {1, 2, 3})));
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(ComesBack({{0, 0, 0}, {100, 0, 0}, {infinite, 0, 0}, {0, 0, 0}, {0, 1, 0}}));
  EXPECT_FALSE(ComesBack({{0, 0, 0}, {1e300, 0, 0}, {-1e300, 0, 0}}));
}

// By all pairs it would be 10^10 of them, minutes.
TEST(ComesBack, AWayOfTwoHundredKilometresTakesNoTime) {
  Way places;
  for (int i = 0; i < 200'000; ++i) places.emplace_back(i, 0, 0);
  EXPECT_FALSE(ComesBack(places));
}

}  // namespace
}  // namespace rgbdt
