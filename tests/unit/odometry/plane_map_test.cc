#include "calib/odometry/internal/plane_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace rgbdt::odometry {
namespace {

using Eigen::Vector3d;

constexpr double kRange = 0.01;  // [m] noise of a range

// Points of a floor at z = -1, of rings that hit it at these x, with noise along their beams.
std::vector<MapPoint> Floor(const std::vector<double>& xs, double sigma) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0, sigma);
  std::vector<MapPoint> points;
  std::uint32_t ring = 0;
  for (const double x : xs) {
    ++ring;
    for (double y = -1.5; y < 1.5; y += 0.01) {
      const Vector3d place(x, y, -1.03);
      points.push_back({place + noise(random) * place.normalized(), ring});
    }
  }
  return points;
}

TEST(PlaneMap, APlaneIsFoundAndItsNormalIsAsGoodAsItSays) {
  PlaneMap map(kRange);
  map.Add(Floor({5.0, 5.2, 5.4, 5.6, 5.8, 6.0, 6.2}, kRange), Vector3d::Zero());
  const Match match = map.Find({5.5, 0.4, -1.02});
  ASSERT_NE(match.plane, nullptr);
  EXPECT_TRUE(match.plane->reliable);
  EXPECT_GT(match.level, 1) << "of a flat floor the larger voxels tell more";
  EXPECT_NEAR(std::abs(match.plane->normal.z()), 1, 1e-3);
  EXPECT_NEAR(match.plane->mean.z(), -1.03, 0.005);
  EXPECT_LT(std::sqrt(match.plane->normal_covariance.trace()), 0.03);
}

// One ring's points lie on its cone: a plane that leans towards the beams.
TEST(PlaneMap, OneLineTellsNoPlane) {
  PlaneMap map(kRange);
  map.Add(Floor({5.5}, kRange), Vector3d::Zero());
  EXPECT_EQ(map.Find({5.5, 0.4, -1.03}).plane, nullptr);
  // Again from elsewhere it is another line.
  std::vector<MapPoint> moved = Floor({6.2}, kRange);
  for (MapPoint& p : moved) p.elevation = 1;
  map.Add(moved, Vector3d(0.7, 0, 0));
  EXPECT_NE(map.Find({5.7, 0.4, -1.03}).plane, nullptr);
}

TEST(PlaneMap, NothingWhereNothingWasSeenAndNothingFromWhatIsNoPlace) {
  PlaneMap map(kRange);
  EXPECT_EQ(map.Find({0, 0, 0}).plane, nullptr);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  map.Add({{Vector3d(nan, 0, 0), 0}, {Vector3d(1e12, 0, 0), 0}}, Vector3d::Zero());
  EXPECT_EQ(map.size(), 0U);
  EXPECT_EQ(map.Find({nan, 0, 0}).plane, nullptr);
}

TEST(PlaneMap, WhatIsFarIsForgotten) {
  PlaneMap map(kRange);
  map.Add(Floor({5.0, 5.2, 5.4, 5.6, 5.8, 6.0}, kRange), Vector3d::Zero());
  map.Forget({0, 0, 0}, 100);
  EXPECT_NE(map.Find({5.5, 0.4, -1.03}).plane, nullptr);
  map.Forget({50, 0, 0}, 20);
  EXPECT_EQ(map.size(), 0U);
  EXPECT_EQ(map.Find({5.5, 0.4, -1.03}).plane, nullptr);
}

TEST(Moments, AreThoseOfThePointsAboutAnyMiddle) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  Moments about_here, about_there;
  const Vector3d shift(0.3, -0.2, 0.7);
  for (int i = 0; i < 100; ++i) {
    const Vector3d p(normal(random), 2 * normal(random), 0.1 * normal(random));
    about_here.Add(p);
    about_there.Add(p + shift);
  }
  const Moments shifted = about_here.Shifted(shift);
  EXPECT_LT((shifted.Covariance() - about_there.Covariance()).norm(), 1e-12);
  EXPECT_LT((shifted.sum - about_there.sum).norm(), 1e-12);
}

}  // namespace
}  // namespace rgbdt::odometry
