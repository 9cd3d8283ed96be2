#include "calib/methods/natural/depth_edges.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rgbdt {
namespace {

constexpr double kStep = 0.01;  // between beams [rad]

/// A grid of beams about x, `range_of(azimuth, elevation)` [m] apart; 0: nothing returns.
template <typename Range>
Cloud GridOf(int lines, int beams, Range range_of) {
  Cloud cloud;
  cloud.lines = lines;
  cloud.beams = beams;
  for (int line = 0; line < lines; ++line) {
    for (int beam = 0; beam < beams; ++beam) {
      const double azimuth = kStep * (line - lines / 2);
      const double elevation = kStep * (beam - beams / 2);
      const Eigen::Vector3d direction(std::cos(elevation) * std::cos(azimuth),
                                      std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      const double range = range_of(azimuth, elevation);
      const Eigen::Vector3d point = range * direction;
      cloud.directions.push_back(direction.cast<float>());
      cloud.points.push_back(range > 0 ? Eigen::Vector3f(point.cast<float>())
                                       : Eigen::Vector3f::Constant(std::nanf("")));
      cloud.intensity.push_back(0.5F);
    }
  }
  return cloud;
}

TEST(BeyondRim, HalvesTheBeamAtTheRim) {
  EXPECT_NEAR(BeyondRim(0.5), 0, 1e-9);
  EXPECT_NEAR(BeyondRim(0.2), -BeyondRim(0.8), 1e-9);
  const double d = BeyondRim(0.1);
  EXPECT_NEAR((std::acos(d) - d * std::sqrt(1 - d * d)) / M_PI, 0.1, 1e-9);
  EXPECT_GT(d, 0.6);  // a beam whose middle lies beyond the rim is covered by less than half
}

// A sheet 4 m away before a wall at 8 m: its left and right ends, upper and lower.
TEST(FindDepthEdges, LieWithinHalfAStepOfTheRim) {
  const double half = 0.123;
  const Cloud cloud = GridOf(60, 60, [&](double azimuth, double elevation) {
    return std::abs(azimuth) < half && std::abs(elevation) < half ? 4.0 : 8.0;
  });
  const auto edges = FindDepthEdges(RangeGrid(cloud));
  ASSERT_GE(edges.size(), 60U);
  int left = 0, up = 0;
  for (const SceneEdge& edge : edges) {
    EXPECT_NEAR(edge.point.norm(), 4, 0.02);
    const double azimuth = std::atan2(edge.point.y(), edge.point.x());
    const double elevation = std::asin(edge.point.z() / edge.point.norm());
    const bool upright = std::abs(std::abs(azimuth) - half) <= 0.51 * kStep;
    const bool level = std::abs(std::abs(elevation) - half) <= 0.51 * kStep;
    EXPECT_TRUE(upright || level) << azimuth << " " << elevation;
    EXPECT_GT(edge.across.dot(edge.point - Eigen::Vector3d(4, 0, 0)), 0) << "not outwards";
    EXPECT_NEAR(edge.across.norm(), 0.5 * kStep * 4, 0.002);
    if (upright && std::abs(elevation) < half - 0.06) {
      EXPECT_GT(std::abs(edge.along.z()), 0.95);
      left += azimuth > 0 ? 1 : 0;
    }
    if (level && std::abs(azimuth) < half - 0.06) {
      EXPECT_GT(std::abs(edge.along.y()), 0.95);
      up += elevation > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(left, 5);
  EXPECT_GT(up, 5);
}

TEST(FindDepthEdges, ABeamThatReturnedNothingIsFarAway) {
  const Cloud cloud =
      GridOf(60, 60, [](double azimuth, double) { return azimuth < 0 ? 4.0 : 0.0; });
  const auto edges = FindDepthEdges(RangeGrid(cloud));
  ASSERT_GT(edges.size(), 30U);
  for (const SceneEdge& edge : edges) {
    EXPECT_NEAR(std::atan2(edge.point.y(), edge.point.x()), -0.5 * kStep, 0.01 * kStep);
    EXPECT_GT(edge.reach, 0.5);  // a little of the beam is enough there
    EXPECT_EQ(edge.rim, edges[0].rim);
  }
}

TEST(FindDepthEdges, SinglePointsAndEvenGroundHaveNone) {
  const Cloud stray = GridOf(60, 60, [](double azimuth, double elevation) {
    return std::abs(azimuth) < 0.4 * kStep && std::abs(elevation) < 0.4 * kStep ? 4.0 : 8.0;
  });
  EXPECT_TRUE(FindDepthEdges(RangeGrid(stray)).empty());
  const Cloud ground = GridOf(60, 60, [](double, double elevation) {
    return elevation < -0.02 ? 1.2 / std::sin(-elevation) : 0.0;
  });
  for (const SceneEdge& edge : FindDepthEdges(RangeGrid(ground))) {
    ADD_FAILURE() << "an edge on even ground, " << edge.point.transpose();
  }
}

}  // namespace
}  // namespace rgbdt
