#include "calib/methods/natural/reflectivity_edges.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rgbdt {
namespace {

constexpr double kStep = 0.01;  // between beams [rad]
constexpr int kBeams = 60;

/// A wall at x = 4 m, each beam's light drawn about `light_of(y, z)`, its lines not equally
/// sensitive.
template <typename Light>
Cloud WallOf(Light light_of, double range_step_m = 0) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, 0.01);
  Cloud cloud;
  cloud.lines = cloud.beams = kBeams;
  for (int line = 0; line < kBeams; ++line) {
    const double gain = 1 + 0.4 * std::sin(2.0 * line);
    for (int beam = 0; beam < kBeams; ++beam) {
      const Eigen::Vector3d at(1, kStep * (line - kBeams / 2), kStep * (beam - kBeams / 2));
      const double x = 4 + (beam > 40 ? range_step_m : 0);
      cloud.directions.push_back(at.normalized().cast<float>());
      cloud.points.push_back((x * at).cast<float>());
      cloud.intensity.push_back(
          static_cast<float>(gain * (light_of(4 * at.y(), 4 * at.z()) + noise(random))));
    }
  }
  return cloud;
}

// A bright sheet, turned by 20 degrees, on a dark wall.
double Sheet(double y, double z) {
  const double c = std::cos(0.35), s = std::sin(0.35);
  return std::abs(c * y + s * z) < 0.6 && std::abs(c * z - s * y) < 0.4 ? 0.7 : 0.25;
}

TEST(FindReflectivityEdges, LieOnASheetsSidesAndPointOutOfIt) {
  const Cloud cloud = WallOf(Sheet);
  const auto edges = FindReflectivityEdges(RangeGrid(cloud));
  ASSERT_GT(edges.size(), 60U);
  const double c = std::cos(0.35), s = std::sin(0.35);
  for (const SceneEdge& edge : edges) {
    const double u = c * edge.point.y() + s * edge.point.z();
    const double v = c * edge.point.z() - s * edge.point.y();
    const bool by_u = std::abs(std::abs(u) - 0.6) < std::abs(std::abs(v) - 0.4);
    const double off = by_u ? std::abs(u) - 0.6 : std::abs(v) - 0.4;
    EXPECT_LE(std::abs(off), 0.55 * 4 * kStep) << u << " " << v;
    EXPECT_NEAR(edge.point.x(), 4, 0.01);
    const double out_u = u * (c * edge.across.y() + s * edge.across.z());
    const double out_v = v * (c * edge.across.z() - s * edge.across.y());
    EXPECT_GT(by_u ? out_u : out_v, 0) << "not outwards";
    EXPECT_EQ(edge.kind, SceneEdgeKind::kReflectivity);
    EXPECT_EQ(edge.reach, 0);
    const double along_u = std::abs(c * edge.along.y() + s * edge.along.z());
    const bool near_a_corner = std::abs(u) > 0.4 && std::abs(v) > 0.2;
    if (near_a_corner) continue;
    EXPECT_GT(std::max(along_u, std::sqrt(1 - along_u * along_u)), 0.95);
  }
}

// Also where lines are not equally sensitive: they are 0.6 to 1.4 times as bright.
TEST(FindReflectivityEdges, AnEvenWallHasNone) {
  const auto even = [](double, double) { return 0.4; };
  EXPECT_TRUE(FindReflectivityEdges(RangeGrid(WallOf(even))).empty());
  const auto gradual = [](double y, double z) { return 0.4 + 0.1 * y + 0.05 * z; };
  EXPECT_TRUE(FindReflectivityEdges(RangeGrid(WallOf(gradual))).empty());
}

TEST(FindReflectivityEdges, WhereTheSurfaceEndsIsNone) {
  const auto light = [](double, double z) { return z > 4 * kStep * 10.5 ? 0.7 : 0.25; };
  const Cloud cloud = WallOf(light, 0.5);
  EXPECT_TRUE(FindReflectivityEdges(RangeGrid(cloud)).empty());
  EXPECT_FALSE(FindReflectivityEdges(RangeGrid(WallOf(light))).empty());
}

TEST(FindReflectivityEdges, WithoutIntensitiesThereAreNone) {
  Cloud cloud = WallOf(Sheet);
  cloud.intensity.clear();
  EXPECT_TRUE(FindReflectivityEdges(RangeGrid(cloud)).empty());
}

}  // namespace
}  // namespace rgbdt
