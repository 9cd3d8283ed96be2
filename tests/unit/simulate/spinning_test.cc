#include "calib/simulate/internal/spinning.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include "calib/model/errors.h"
#include "calib/simulate/imperfections.h"
#include "calib/simulate/internal/cloud_world.h"
#include "tests/simulated_variants.h"
#include "tests/unit/simulate/simulate_testing.h"

namespace rgbdt::simulate {
namespace {

using Eigen::Vector3d;

/// A wall across x at 5 m, as wide as the LIDAR looks ahead; nothing elsewhere.
World WallWorld() {
  const Mesh wall = MakeQuad({5, -50, -50}, {5, 50, -50}, {5, 50, 50}, {5, -50, 50});
  return SheetWorld({wall}, 0.5, Options());
}

SpinningOptions Quiet(int rings) {
  SpinningOptions options = SpinningLidar(rings);
  options.range_sigma_m = 1e-9;
  return options;
}

std::size_t At(const Cloud& cloud, int ring, int column) {
  return static_cast<std::size_t>(ring) * static_cast<std::size_t>(cloud.beams) +
         static_cast<std::size_t>(column);
}

/// Unlike ==, takes a NaN as equal to itself.
bool Same(const std::vector<Eigen::Vector3f>& a, const std::vector<Eigen::Vector3f>& b) {
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(), a.size() * sizeof(Eigen::Vector3f)) == 0;
}

TEST(SpinningLidar, HasTheRingsOfItsKind) {
  const SpinningOptions vlp16 = SpinningLidar(16);
  EXPECT_EQ(vlp16.columns(), 1800);
  for (int ring = 0; ring < 16; ++ring) {
    EXPECT_NEAR(vlp16.elevations_rad[static_cast<std::size_t>(ring)], (-15 + 2 * ring) * kDegree,
                1e-12);
  }
  EXPECT_DOUBLE_EQ(vlp16.range_sigma_m, 0.02);
  const SpinningOptions beams32 = SpinningLidar(32);
  EXPECT_NEAR(beams32.elevations_rad[0], -30.67 * kDegree, 1e-12);
  EXPECT_NEAR(beams32.elevations_rad[1], -29.34 * kDegree, 1e-4);
  EXPECT_NEAR(beams32.elevations_rad[31], 10.67 * kDegree, 1e-12);
  EXPECT_EQ(SpinningLidar(64).columns(), 2118);
  EXPECT_NEAR(SpinningLidar(64).elevations_rad[63], 2 * kDegree, 1e-12);
  EXPECT_NEAR(SpinningLidar(128).elevations_rad[0], -25 * kDegree, 1e-12);
  EXPECT_EQ(SpinningLidar(128).rings(), 128);
  EXPECT_THROW(SpinningLidar(40), InputError);
}

TEST(SpinningSweep, IsRingByAzimuth) {
  SpinningOptions options = Quiet(16);
  options.revolution_s = 0.18;
  const Cloud cloud = SpinningSweep(WallWorld(), options, 1, 1000000);
  EXPECT_TRUE(cloud.organised);
  EXPECT_EQ(cloud.lines, 16);
  EXPECT_EQ(cloud.beams, 1800);
  EXPECT_EQ(cloud.sweep_utime, 1000000);
  ASSERT_EQ(cloud.size(), 28800U);
  for (const int ring : {0, 5, 15}) {
    for (const int column : {0, 1, 899, 1799}) {
      const std::size_t i = At(cloud, ring, column);
      const Vector3d d = cloud.directions[i].cast<double>();
      EXPECT_NEAR(std::asin(d.z()), (-15 + 2 * ring) * kDegree, 1e-6);
      const double off = std::atan2(d.y(), d.x()) - (-180 + 0.2 * column) * kDegree;
      EXPECT_NEAR(std::remainder(off, 360 * kDegree), 0, 1e-6);
      EXPECT_EQ(cloud.ring[i], ring);
      EXPECT_EQ(cloud.utime[i], 1000000 + 100 * column);
    }
  }
}

TEST(SpinningSweep, RingsMeetAWallWhereGeometrySays) {
  const Cloud cloud = SpinningSweep(WallWorld(), Quiet(32), 1, 0);
  int hits = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vector3d d = cloud.directions[i].cast<double>();
    const double expected = 5 / d.x();
    if (d.x() < 0.15) {
      EXPECT_FALSE(cloud.IsHit(i) && d.x() < 0.08);
      continue;
    }
    ++hits;
    ASSERT_TRUE(cloud.IsHit(i));
    // The beam's width shifts a slanted return: by (divergence / 2)^2 / 4 / cos^2 of its range.
    const double tolerance = 2e-6 + expected * 1.5e-6 / (d.x() * d.x());
    ASSERT_NEAR(cloud.points[i].cast<double>().norm(), expected, tolerance);
    ASSERT_NEAR(cloud.points[i].cast<double>().normalized().dot(d), 1, 1e-6);
    ASSERT_NEAR(cloud.intensity[i], 0.5, 0.07);  // sigma 0.01
  }
  EXPECT_GT(hits, 20000);
}

TEST(SpinningSweep, MissesAreNanWithADirection) {
  const Cloud cloud = SpinningSweep(WallWorld(), Quiet(16), 1, 0);
  for (int ring = 0; ring < 16; ++ring) {
    const std::size_t behind = At(cloud, ring, 0);
    EXPECT_TRUE(cloud.points[behind].array().isNaN().all());
    EXPECT_NEAR(cloud.directions[behind].norm(), 1, 1e-6);
    EXPECT_EQ(cloud.intensity[behind], 0);
    EXPECT_TRUE(cloud.IsHit(At(cloud, ring, 900)));
  }
  SpinningOptions blind = Quiet(16);
  blind.max_range_m = 4;
  EXPECT_EQ(Unorganised(SpinningSweep(WallWorld(), blind, 1, 0), true).size(), 0U);
}

TEST(SpinningSweep, RingsMayFireOneAfterAnother) {
  SpinningOptions options = Quiet(16);
  options.firing_share = 0.5;
  const Cloud cloud = SpinningSweep(WallWorld(), options, 1, 0);
  const Eigen::Vector3f d = cloud.directions[At(cloud, 8, 900)];
  EXPECT_NEAR(std::atan2(d.y(), d.x()), 0.25 * 0.2 * kDegree, 1e-6);
  // The point lies where its beam went.
  EXPECT_NEAR(cloud.points[At(cloud, 8, 900)].normalized().dot(d), 1, 1e-6);
  EXPECT_EQ(cloud.utime[At(cloud, 8, 900)], std::llround(900.25 * 1e5 / 1800));
}

TEST(SpinningSweep, BiasIsConstantForARingAndOffsetForAll) {
  const Cloud truth = SpinningSweep(WallWorld(), Quiet(16), 7, 0);
  SpinningOptions options = Quiet(16);
  options.ring_bias_sigma_m = 0.02;
  options.range_offset_m = -0.03;
  const auto bias_at = [&](int ring, int column, Utime utime) {
    const Cloud cloud = SpinningSweep(WallWorld(), options, 7, utime);
    const std::size_t i = At(cloud, ring, column);
    return double(cloud.points[i].norm()) - double(truth.points[i].norm());
  };
  double squares = 0;
  for (int ring = 0; ring < 16; ++ring) {
    const double bias = bias_at(ring, 900, 0);
    EXPECT_NEAR(bias, -0.03 + RingBias(options, 7, ring), 2e-6);
    EXPECT_NEAR(bias, bias_at(ring, 870, 5000000), 2e-6);
    squares += (bias + 0.03) * (bias + 0.03);
  }
  // 16 draws: within a factor that chi-squared exceeds once in thousands.
  EXPECT_GT(std::sqrt(squares / 16), 0.01);
  EXPECT_LT(std::sqrt(squares / 16), 0.036);
}

/// A plane that leans away as it rises: x - z / 2 = 5.
World LeaningWorld(double reflectivity) {
  const Mesh sheet = MakeQuad({2.5, -20, -5}, {2.5, 20, -5}, {7.5, 20, 5}, {7.5, -20, 5});
  return SheetWorld({sheet}, reflectivity, Options());
}

TEST(SpinningSweep, DarkSurfacesLieFartherByASmoothFunction) {
  const auto error_at = [](double reflectivity) {
    SpinningOptions options = Quiet(16);
    const World world = LeaningWorld(reflectivity);
    const Cloud truth = SpinningSweep(world, options, 1, 0);
    options.dark_range_m = 0.02;
    const Cloud cloud = SpinningSweep(world, options, 1, 0);
    const std::size_t i = At(cloud, 7, 900);
    return double(cloud.points[i].norm()) - double(truth.points[i].norm());
  };
  // 20 mm times e to the minus 1/36, 1/9, 1, 49/9.
  EXPECT_NEAR(error_at(0.05), 0.019452, 2e-6);
  EXPECT_NEAR(error_at(0.10), 0.017897, 2e-6);
  EXPECT_NEAR(error_at(0.30), 0.007358, 2e-6);
  EXPECT_NEAR(error_at(0.70), 0.000086, 2e-6);
}

TEST(SpinningSweep, DarkSurfacesAreNoisier) {
  const auto sigma_at = [](double reflectivity) {
    SpinningOptions options = Quiet(16);
    const World world = LeaningWorld(reflectivity);
    const Cloud truth = SpinningSweep(world, options, 1, 0);
    options.range_sigma_m = 0.01;
    options.dark_noise = 3;
    const Cloud cloud = SpinningSweep(world, options, 1, 0);
    double squares = 0;
    constexpr int kFirst = 700, kLast = 1100;
    for (int column = kFirst; column < kLast; ++column) {
      const std::size_t i = At(cloud, 7, column);
      const double off = double(cloud.points[i].norm()) - double(truth.points[i].norm());
      squares += off * off / (kLast - kFirst);
    }
    return std::sqrt(squares);
  };
  // 1 + 2 e^(-1/9) times 10 mm, and 10 mm; of 400 draws: 3.5% is 1 sigma.
  EXPECT_NEAR(sigma_at(0.1), 0.01 * (1 + 2 * std::exp(-1.0 / 9)), 0.004);
  EXPECT_NEAR(sigma_at(0.9), 0.01, 0.0015);
}

// A VLP-16's: 11.2 mm higher at -15 degrees, as much lower at 15.
TEST(SpinningSweep, BeamsThatMeetStartAtTheirOwnHeights) {
  EXPECT_NEAR(0.042 * std::tan(15 * kDegree), 0.0112, 1e-4);
  SpinningOptions options = Quiet(16);
  options.beams_meet_m = 0.042;
  const Cloud cloud = SpinningSweep(LeaningWorld(0.5), options, 1, 0);
  for (int ring = 0; ring < 16; ++ring) {
    const double elevation = (-15 + 2 * ring) * kDegree;
    const double start_z = -0.042 * std::tan(elevation);
    for (const int column : {850, 900, 930}) {
      const std::size_t i = At(cloud, ring, column);
      const double azimuth = (-180 + 0.2 * column) * kDegree;
      const Vector3d beam(std::cos(elevation) * std::cos(azimuth),
                          std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      const double range = (5 + 0.5 * start_z) / (beam.x() - 0.5 * beam.z());
      const Vector3d point = cloud.points[i].cast<double>();
      // Published from the origin; 20e-6: the slanted beam's width.
      ASSERT_NEAR((point - range * beam).norm(), 0, 2e-5) << ring << ' ' << column;
      const Vector3d true_point = point + start_z * Vector3d::UnitZ();
      ASSERT_NEAR(true_point.x() - 0.5 * true_point.z(), 5, 2e-5);
    }
  }
}

TEST(SpinningSweep, RangeNoiseHasItsSigma) {
  const Cloud truth = SpinningSweep(WallWorld(), Quiet(16), 1, 0);
  const Cloud cloud = SpinningSweep(WallWorld(), SpinningLidar(16), 1, 0);
  double squares = 0;
  int count = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!truth.IsHit(i)) continue;
    const double error = double(cloud.points[i].norm()) - double(truth.points[i].norm());
    squares += error * error;
    ++count;
  }
  ASSERT_GT(count, 10000);
  EXPECT_NEAR(std::sqrt(squares / count), 0.02, 0.0006);  // 4 sigma of 10,000 draws
}

TEST(SpinningSweep, IsTheSameEachTimeOnAnyNumberOfThreads) {
  const World world = WallWorld();
  const SpinningOptions options = SpinningLidar(16);
  const Cloud one = SpinningSweep(world, options, 1, 5, 1);
  const Cloud three = SpinningSweep(world, options, 1, 5, 3);
  EXPECT_TRUE(Same(one.points, three.points));
  EXPECT_TRUE(Same(one.directions, three.directions));
  EXPECT_EQ(one.intensity, three.intensity);
  EXPECT_FALSE(Same(one.points, SpinningSweep(world, options, 1, 6).points));
  EXPECT_FALSE(Same(one.points, SpinningSweep(world, options, 2, 5).points));
}

// A rig that is off in all ways that are drawn.
SpinningOptions Imperfect(double firing_share) {
  Options options;
  options.seed = 4;
  UseLidar(16, &options);
  MakeImperfect(&options);
  options.spinning->firing_share = firing_share;
  return *options.spinning;
}

TEST(MovingSweep, IsThatOfAStandingOneWhereItStands) {
  const World world = WallWorld();
  Rigid3 pose = RotationAbout(Vector3d::UnitZ(), 0.3) * RotationAbout(Vector3d::UnitY(), 0.1);
  pose.translation = {-1, 2, 0.5};
  for (const double share : {0.0, 0.9}) {
    const SpinningOptions options = Imperfect(share);
    const Cloud still = SpinningSweep(world, options, 4, 7, 1, pose);
    const Cloud moving = MovingSweep(
        world, options, 4, 7, [&](Utime) { return pose; }, 2);
    EXPECT_TRUE(Same(still.points, moving.points));
    EXPECT_TRUE(Same(still.directions, moving.directions));
    EXPECT_EQ(still.intensity, moving.intensity);
    EXPECT_EQ(still.utime, moving.utime);
    EXPECT_EQ(still.ring, moving.ring);
  }
}

TEST(MovingSweep, EachBeamIsFiredFromWhereTheLidarIsThen) {
  const World world = WallWorld();
  SpinningOptions options = Quiet(16);
  options.firing_share = 0.9;
  // At the wall by 10 m/s.
  const auto at = [](Utime utime) {
    Rigid3 pose;
    pose.translation.x() = 10 * ToSeconds(utime);
    return pose;
  };
  const Cloud cloud = MovingSweep(world, options, 1, 0, at);
  int hits = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    // What is seen under a flat angle goes over the edges of the beam's sub-rays.
    if (!cloud.IsHit(i) || cloud.directions[i].x() < 0.8F) continue;
    ++hits;
    ASSERT_NEAR(cloud.points[i].x(), 5 - 10 * ToSeconds(cloud.utime[i]), 1e-4) << i;
  }
  EXPECT_GT(hits, 3000);
}

TEST(Unorganised, KeepsTheHitsAndNothingElse) {
  const Cloud cloud = SpinningSweep(WallWorld(), SpinningLidar(16), 1, 77);
  const Cloud bare = Unorganised(cloud, true);
  EXPECT_FALSE(bare.organised);
  EXPECT_EQ(bare.lines, 1);
  EXPECT_EQ(bare.beams, static_cast<int>(bare.size()));
  EXPECT_EQ(bare.sweep_utime, 77);
  EXPECT_TRUE(bare.directions.empty() && bare.origins.empty());
  std::size_t next = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud.IsHit(i)) continue;
    ASSERT_LT(next, bare.size());
    ASSERT_EQ(bare.points[next], cloud.points[i]);
    ASSERT_EQ(bare.ring[next], cloud.ring[i]);
    ASSERT_EQ(bare.utime[next], cloud.utime[i]);
    ASSERT_EQ(bare.intensity[next], cloud.intensity[i]);
    ++next;
  }
  EXPECT_EQ(next, bare.size());
  EXPECT_LT(bare.size(), cloud.size());
}

TEST(Unorganised, ShufflesPointsWithWhatBelongsToThem) {
  const Cloud cloud = SpinningSweep(WallWorld(), SpinningLidar(16), 1, 0);
  const Cloud in_order = Unorganised(cloud, true);
  const Cloud shuffled = Unorganised(cloud, true, 3);
  ASSERT_EQ(shuffled.size(), in_order.size());
  EXPECT_FALSE(Same(shuffled.points, in_order.points));
  EXPECT_TRUE(Same(shuffled.points, Unorganised(cloud, true, 3).points));
  EXPECT_FALSE(Same(shuffled.points, Unorganised(cloud, true, 4).points));
  const auto sorted = [](const Cloud& c) {
    std::vector<std::size_t> order(c.size());
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return std::tie(c.ring[a], c.utime[a]) < std::tie(c.ring[b], c.utime[b]);
    });
    std::vector<Eigen::Vector3f> points;
    for (const std::size_t i : order) points.push_back(c.points[i]);
    return points;
  };
  EXPECT_TRUE(Same(sorted(shuffled), sorted(in_order)));
  EXPECT_TRUE(Unorganised(cloud, false, 3).ring.empty());
}

}  // namespace
}  // namespace rgbdt::simulate
