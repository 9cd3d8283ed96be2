#include "calib/terrain/terrain.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>

#include "tests/numbers.h"
#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

using ::testing::HasSubstr;
using Surface = std::function<double(double x, double y)>;

// Points every `apart` metres over [-size, size]^2, with noise in z.
MapCloud Sampled(const Surface& surface, double size = 4, double apart = 0.04,
                 double noise_m = 0.01) {
  Random random(1);
  MapCloud cloud;
  for (double x = -size; x < size; x += apart) {
    for (double y = -size; y < size; y += apart) {
      const double z = surface(x, y) + random.Uniform(-1.7, 1.7) * noise_m;
      cloud.points.emplace_back(static_cast<float>(x), static_cast<float>(y),
                                static_cast<float>(z));
    }
  }
  return cloud;
}

std::size_t CellAt(const TerrainGrid& grid, double x, double y) {
  return grid.Index(static_cast<int>((x - grid.origin.x()) / grid.cell_m),
                    static_cast<int>((y - grid.origin.y()) / grid.cell_m));
}

CellState StateAt(const Terrain& terrain, double x, double y) {
  return terrain.grid.state[CellAt(terrain.grid, x, y)];
}

double Share(const Terrain& terrain, CellState state) {
  return static_cast<double>(
             std::count(terrain.grid.state.begin(), terrain.grid.state.end(), state)) /
         static_cast<double>(terrain.grid.size());
}

TEST(Terrain, LevelGroundIsTraversableAndASite) {
  const Terrain terrain = FindTerrain(Sampled([](double, double) { return -1.2; }), {});
  EXPECT_EQ(Share(terrain, CellState::kTraversable), 1);
  ASSERT_FALSE(terrain.sites.empty());
  const LandingSite& best = terrain.sites[0];
  EXPECT_NEAR(best.centre.z(), -1.2, 0.01);
  EXPECT_GT(best.radius_m, 3.5);
  EXPECT_LT(best.radius_m, 4);
  EXPECT_LT(best.slope_rad, 0.3 * kDegree);
  EXPECT_NEAR(best.roughness_m, 0.01, 0.004);
  EXPECT_TRUE(std::isinf(best.clearance_m));
  EXPECT_TRUE(std::isnan(best.temperature_k));
}

TEST(Terrain, SlopesAreMeasured) {
  for (const double degrees : {5.0, 10.0, 15.0, 25.0}) {
    const double slope = std::tan(degrees * kDegree);
    const Terrain terrain =
        FindTerrain(Sampled([&](double x, double y) { return slope * (0.8 * x + 0.6 * y); }), {});
    const std::size_t cell = CellAt(terrain.grid, 0.1, 0.1);
    EXPECT_NEAR(terrain.grid.slope_rad[cell] / kDegree, degrees, 0.7);
    EXPECT_LT(terrain.grid.step_m[cell], 0.03);
    EXPECT_EQ(terrain.grid.state[cell] == CellState::kTraversable, degrees < 20);
    EXPECT_EQ(terrain.sites.empty(), degrees > 14);
  }
}

TEST(Terrain, AKerbIsAnObstacleOneCellWide) {
  for (const double kerb : {0.05, 0.15, 0.3}) {
    const Terrain terrain =
        FindTerrain(Sampled([&](double x, double) { return x > 0.07 ? kerb : 0.0; }), {});
    EXPECT_EQ(StateAt(terrain, 0.1, 1.1) == CellState::kObstacle, kerb > 0.1) << kerb;
    EXPECT_EQ(StateAt(terrain, -0.3, 1.1), CellState::kTraversable) << kerb;
    EXPECT_EQ(StateAt(terrain, 0.5, 1.1), CellState::kTraversable) << kerb;
    EXPECT_LT(terrain.grid.slope_rad[CellAt(terrain.grid, 0.5, 1.1)], 3 * kDegree);
  }
}

// On a slope of 10 degrees: a table at 0.5 m, seen from above, is in the way; a branch is not.
TEST(Terrain, WhatHangsHighEnoughIsNoObstacle) {
  const double slope = std::tan(10 * kDegree);
  for (const double height : {0.3, 0.5, 1.2, 3.0}) {
    MapCloud cloud = Sampled([&](double x, double) { return slope * x; });
    for (double x = 1; x < 1.6; x += 0.05) {
      for (double y = 1; y < 1.6; y += 0.05) {
        cloud.points.emplace_back(x, y, slope * x + height);
      }
    }
    const Terrain terrain = FindTerrain(cloud, {});
    EXPECT_EQ(StateAt(terrain, 1.3, 1.3) == CellState::kObstacle, height < 1.5) << height;
    EXPECT_EQ(terrain.grid.overhead[CellAt(terrain.grid, 1.3, 1.3)] != 0, height > 1.5);
    for (const LandingSite& site : terrain.sites) {
      const Eigen::Vector2d middle(1.3, 1.3);
      EXPECT_GT((site.centre.head<2>() - middle).norm(), site.radius_m) << "no site under it";
    }
  }
}

TEST(Terrain, ACrateHidesItsGround) {
  const auto crate = [](double x, double y) {
    return std::abs(x - 1) < 0.55 && std::abs(y) < 0.55 ? 0.6 : 0.0;
  };
  const Terrain terrain = FindTerrain(Sampled(crate), {});
  for (const double x : {0.5, 0.7, 0.9, 1.1, 1.3, 1.5}) {
    EXPECT_EQ(StateAt(terrain, x + 0.01, 0.1), CellState::kObstacle) << x;
  }
  EXPECT_EQ(StateAt(terrain, 1, 1.1), CellState::kTraversable);
  EXPECT_NEAR(terrain.grid.step_m[CellAt(terrain.grid, 1.01, 0.1)], 0.6, 0.05);
}

// Two walls 0.34 m apart, and two 0.74 m apart: the rover is 0.5 m wide.
TEST(Terrain, AGapNarrowerThanTheVehicleIsClosed) {
  const auto walls = [](double x, double y) {
    const double gap = y > 0 ? 0.17 : 0.37;
    return std::abs(x - 0.1) > gap && std::abs(x - 0.1) < gap + 0.5 ? 1.0 : 0.0;
  };
  const Terrain terrain = FindTerrain(Sampled(walls), {});
  EXPECT_EQ(StateAt(terrain, 0.1, 2.1), CellState::kObstacle);
  EXPECT_EQ(StateAt(terrain, 0.1, -2.1), CellState::kTraversable);
}

TEST(Terrain, ASingleStrayPointIsNoObstacleAndNoGround) {
  MapCloud cloud = Sampled([](double, double) { return 0; });
  cloud.points.emplace_back(1.1F, 1.1F, 0.7F);
  cloud.points.emplace_back(-1.1F, 1.1F, -5.0F);
  const Terrain terrain = FindTerrain(cloud, {});
  EXPECT_EQ(Share(terrain, CellState::kTraversable), 1);
}

TEST(Terrain, AHoleInTheDataIsUnknownAndOneCellIsFilled) {
  MapCloud cloud = Sampled([](double, double) { return 0; });
  const auto in_hole = [](const Eigen::Vector3f& p) {
    const bool large = p.x() > 1 && p.x() < 2 && p.y() > 1 && p.y() < 2;
    const bool small = p.x() > -1.22F && p.x() < -0.98F && p.y() > 0.98F && p.y() < 1.22F;
    return large || small;
  };
  cloud.points.erase(std::remove_if(cloud.points.begin(), cloud.points.end(), in_hole),
                     cloud.points.end());
  const Terrain terrain = FindTerrain(cloud, {});
  EXPECT_EQ(StateAt(terrain, 1.5, 1.5), CellState::kUnknown);
  EXPECT_EQ(StateAt(terrain, -1.1, 1.1), CellState::kTraversable);
  EXPECT_EQ(terrain.grid.interpolated[CellAt(terrain.grid, -1.1, 1.1)], 1);
  for (const LandingSite& site : terrain.sites) {
    EXPECT_GT((site.centre.head<2>() - Eigen::Vector2d(1.5, 1.5)).norm(), site.radius_m + 0.4);
    EXPECT_GT((site.centre.head<2>() - Eigen::Vector2d(-1.1, 1.1)).norm(), site.radius_m);
  }
}

TEST(Terrain, RoughGroundIsAnObstacle) {
  const Terrain terrain = FindTerrain(Sampled([](double, double) { return 0; }, 3, 0.04, 0.08), {});
  EXPECT_GT(Share(terrain, CellState::kObstacle), 0.9);
}

TEST(Terrain, SitesAreRankedApartAndInTheClear) {
  const auto post = [](double x, double y) { return std::hypot(x, y) < 0.2 ? 1.0 : 0.0; };
  const Terrain terrain = FindTerrain(Sampled(post, 6), {});
  ASSERT_GE(terrain.sites.size(), 3U);
  for (std::size_t i = 0; i < terrain.sites.size(); ++i) {
    const LandingSite& site = terrain.sites[i];
    const double to_post = site.centre.head<2>().norm() - 0.2;
    EXPECT_GE(site.radius_m, 1);
    EXPECT_GT(to_post, site.radius_m);
    EXPECT_NEAR(site.clearance_m, to_post, 0.35);
    EXPECT_LE(site.clearance_m, to_post);
    EXPECT_LE(site.score, terrain.sites[i == 0 ? 0 : i - 1].score);
    for (std::size_t k = 0; k < i; ++k) {
      const double apart = (site.centre - terrain.sites[k].centre).head<2>().norm();
      EXPECT_GE(apart, site.radius_m + terrain.sites[k].radius_m);
    }
  }
}

TEST(Terrain, TemperatureIsTheMeanByCell) {
  MapCloud cloud = Sampled([](double, double) { return 0; }, 2);
  for (const Eigen::Vector3f& point : cloud.points) {
    cloud.temperature_k.push_back(point.x() > 0 ? 310.0F : 290.0F);
  }
  const Terrain terrain = FindTerrain(cloud, {});
  EXPECT_NEAR(terrain.grid.temperature_k[CellAt(terrain.grid, 1.1, 0.1)], 310, 1e-3);
  EXPECT_NEAR(terrain.grid.temperature_k[CellAt(terrain.grid, -1.1, 0.1)], 290, 1e-3);
}

TEST(Terrain, TheSameInputGivesTheSameOutput) {
  const MapCloud cloud = Sampled([](double x, double y) { return 0.2 * std::sin(x) * y; });
  const Terrain a = FindTerrain(cloud, {}), b = FindTerrain(cloud, {});
  EXPECT_EQ(a.grid.state, b.grid.state);
  EXPECT_EQ(
      std::memcmp(a.grid.slope_rad.data(), b.grid.slope_rad.data(), a.grid.size() * sizeof(float)),
      0);
  ASSERT_EQ(a.sites.size(), b.sites.size());
  for (std::size_t i = 0; i < a.sites.size(); ++i) EXPECT_EQ(a.sites[i].centre, b.sites[i].centre);
}

TEST(Terrain, AFewPointsAreUnknown) {
  MapCloud cloud;
  cloud.points = {{1, 1, 0}, {1, 1.01F, 0}, {5, 1, 2}};
  const Terrain terrain = FindTerrain(cloud, {});
  EXPECT_EQ(Share(terrain, CellState::kUnknown), 1);
  EXPECT_TRUE(terrain.sites.empty());
}

TEST(Terrain, BadInputIsRefusedWithItsValues) {
  const auto error = [](const MapCloud& cloud, const TerrainOptions& options = {}) {
    return InputErrorOf([&] { FindTerrain(cloud, options); });
  };
  EXPECT_THAT(error({}), HasSubstr("0 points"));
  MapCloud nothing;
  nothing.points = {{NAN, 1, 1}};
  EXPECT_THAT(error(nothing), HasSubstr("none of 1 points"));
  MapCloud wide;
  wide.points = {{0, 0, 0}, {1e30F, -1e30F, 0}};
  EXPECT_THAT(error(wide), HasSubstr("cells of 0.2"));
  MapCloud uneven = Sampled([](double, double) { return 0; }, 1);
  uneven.temperature_k = {1};
  EXPECT_THAT(error(uneven), HasSubstr("1 values of temperature_k"));
  TerrainOptions options;
  options.cell_m = -0.2;
  EXPECT_THAT(error(wide, options), testing::AllOf(HasSubstr("cell_m"), HasSubstr("-0.2")));
}

}  // namespace
}  // namespace rgbdt
