#include "calib/simulate/internal/cloud_world.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>

#include "calib/files/points/cloud_files.h"
#include "calib/model/errors.h"
#include "tests/simulated_variants.h"
#include "tests/unit/simulate/simulate_testing.h"

namespace rgbdt::simulate {
namespace {

using Eigen::Vector3d;

/// What clouds are studied on: any orientation, near and far.
Options StudyOptions(int rings) {
  Options options;
  UseLidar(rings, &options);
  options.pose.min_range_m = 1.5;
  options.pose.max_range_m = 10;
  options.pose.max_roll_rad = 180 * kDegree;
  options.pose.max_tilt_rad = 60 * kDegree;
  return options;
}

/// Points within 0.1 m (5 sigma of the noisiest LIDAR) of the board's front, and their mean
/// distance from it.
struct OnBoard {
  int points = 0;
  double mean = 0;
};

OnBoard CountOnBoard(const CloudWorld& world, const Cloud& cloud) {
  const Rigid3 target_from_lidar = world.lidar_from_target().Inverse();
  OnBoard on;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud.IsHit(i)) continue;
    const Vector3d p = target_from_lidar * cloud.points[i].cast<double>();
    if (std::abs(p.x()) > 0.55 || std::abs(p.y()) > 0.4 || std::abs(p.z()) > 0.1) continue;
    on.mean += p.z();
    ++on.points;
  }
  on.mean /= std::max(1, on.points);
  return on;
}

TEST(CloudWorld, SweepsShowTheBoardWhereTheTruthSays) {
  for (const int rings : {0, 16, 32, 64, 128}) {
    for (const int index : {0, 1, 2, 3}) {
      SCOPED_TRACE(std::to_string(rings) + " rings, pose " + std::to_string(index));
      const CloudWorld world(StudyOptions(rings), index);
      const Cloud cloud = world.Sweep(1000000);
      const OnBoard on = CountOnBoard(world, cloud);
      const int least = rings == 0 ? 300 : 15;
      EXPECT_GT(on.points, least);
      EXPECT_NEAR(on.mean, 0, 5 * 0.02 / std::sqrt(on.points));
    }
  }
}

TEST(CloudWorld, PosesAreFoundInEverySceneWithEveryLidar) {
  for (const int rings : {0, 16, 32, 64, 128}) {
    for (const Scene scene : {Scene::kOutdoor, Scene::kIndoor}) {
      Options options = StudyOptions(rings);
      options.scene = scene;
      for (int index = 0; index < 12; ++index) {
        const CloudWorld world(options, index);
        const double range = world.lidar_from_target().translation.norm();
        EXPECT_GE(range, 1.5);
        EXPECT_LE(range, 10);
        if (rings == 0) continue;
        for (const Vector3d& corner : world.target().OutlineCorners()) {
          const Vector3d p = world.lidar_from_target() * corner;
          const double elevation = std::atan2(p.z(), p.head<2>().norm());
          EXPECT_GT(elevation, options.spinning->elevations_rad.front());
          EXPECT_LT(elevation, options.spinning->elevations_rad.back());
        }
      }
    }
  }
}

TEST(CloudWorld, BoardNeedNotLieWhollyInTheField) {
  Options options = StudyOptions(16);
  options.pose.max_range_m = 2;  // 30 degrees are 1.1 m there
  options.pose.whole_in_lidar = false;
  EXPECT_NO_THROW(CloudWorld(options, 0));
  options.pose.whole_in_lidar = true;
  options.pose.max_range_m = options.pose.min_range_m;
  EXPECT_THROW(CloudWorld(options, 0), InputError);
}

TEST(CloudWorld, StandsWhereItIsToldOrHasNoBoard) {
  const Options options;
  const Rigid3 pose = CloudWorld(options, 2).lidar_from_target();
  const CloudWorld same(options, std::optional<Rigid3>(pose));
  EXPECT_EQ(same.lidar_from_target().translation, pose.translation);
  const CloudWorld empty(options, std::nullopt);
  EXPECT_THROW(empty.lidar_from_target(), std::logic_error);
  EXPECT_GT(empty.SpinningSweep(SpinningLidar(16), 0).size(), 0U);
  EXPECT_THROW(CloudWorld(options, -1), InputError);
}

TEST(CloudWorld, TurnedSweepIsItsScannersLines) {
  const Options options;
  const CloudWorld world(options, 1);
  const Cloud cloud = world.TurnedSweep(3000000);
  EXPECT_EQ(cloud.lines, 300);
  EXPECT_EQ(cloud.beams, 400);
  ASSERT_EQ(cloud.origins.size(), 300U);
  const Scanner scanner(options.scanner, options.seed);
  const LineScan line = scanner.Line(world.world(), 3000000, 120);
  for (std::size_t beam = 0; beam < 400; ++beam) {
    const std::size_t i = 120 * 400 + beam;
    EXPECT_EQ(cloud.IsHit(i), std::isfinite(line.range[beam]));
    EXPECT_EQ(cloud.ring[i], beam);
    EXPECT_EQ(cloud.utime[i], line.utime + static_cast<Utime>(beam) * 100);
    if (!cloud.IsHit(i)) continue;
    // While a line is fired its origin moves by up to 0.02 m * 0.2 degrees.
    const Eigen::Vector3f beam_end = cloud.origins[120] + line.range[beam] * cloud.directions[i];
    EXPECT_LT((cloud.points[i] - beam_end).norm(), 8e-5);
  }
}

void ExpectSame(const std::vector<Eigen::Vector3f>& a, const std::vector<Eigen::Vector3f>& b) {
  ASSERT_EQ(a.size(), b.size());
  if (a.empty()) return;
  // Bytes: a NaN is not equal to itself.
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(Eigen::Vector3f)), 0);
}

TEST(CloudWorld, SweepsSurviveTheirFile) {
  const Cloud sweep = CloudWorld(StudyOptions(16), 0).Sweep(1433160000000000);
  const auto path =
      std::filesystem::temp_directory_path() / ("rgbdt-sweep-" + std::to_string(getpid()) + ".pcd");
  for (const Cloud& cloud : {sweep, Unorganised(sweep, true), Unorganised(sweep, false, 1)}) {
    WritePcd(path, cloud);
    const Cloud read = ReadSweep(path, sweep.sweep_utime);
    EXPECT_EQ(read.organised, cloud.organised);
    EXPECT_EQ(read.lines, cloud.lines);
    EXPECT_EQ(read.beams, cloud.beams);
    EXPECT_EQ(read.ring, cloud.ring);
    EXPECT_EQ(read.utime, cloud.utime);
    ExpectSame(read.points, cloud.points);
    ExpectSame(read.directions, cloud.directions);
  }
  std::filesystem::remove(path);
}

TEST(CloudWorld, DenseSweepHas720000Points) {
  Options options;
  options.scanner = DenseScanner();
  EXPECT_NO_THROW(options.Check());
  const Scanner scanner(options.scanner, 1);
  EXPECT_EQ(scanner.sweep_lines(), 800);
  EXPECT_NEAR(scanner.MotorAngle(ToSeconds(800 * scanner.line_period())), 30 * kDegree, 1e-9);
  const ScannerOptions usual;
  EXPECT_NEAR(options.scanner.angle_step_rad * 899, usual.angle_step_rad * 399, 1e-12);
  const Cloud cloud = CloudWorld(options, 0).TurnedSweep(0);
  EXPECT_EQ(cloud.size(), 720000U);
  EXPECT_EQ(cloud.beams, 900);
}

}  // namespace
}  // namespace rgbdt::simulate
