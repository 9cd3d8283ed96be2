// Clouds of a second of LIDARs whose pattern does not repeat, without rings.
#include <gtest/gtest.h>

#include <algorithm>

#include "calib/detect/cloud/board_in_cloud.h"
#include "calib/simulate/internal/cloud_world.h"

namespace rgbdt {
namespace {

simulate::Options LivoxPhysics(int lidar) {
  simulate::Options options;
  simulate::UseLidar(lidar, &options);
  options.pose.min_range_m = 3;
  options.pose.max_range_m = 6;
  options.pose.max_roll_rad = M_PI;
  return options;
}

TEST(LivoxBoard, IsFoundInASecond) {
  for (const int lidar : {simulate::kMid360, simulate::kAvia}) {
    for (int view = 0; view < 4; ++view) {
      const simulate::Options options = LivoxPhysics(lidar);
      const simulate::CloudWorld world(options, view);
      BoardInCloudOptions detection;
      detection.range_sigma_m = options.livox->range_sigma_m;
      const BoardsInCloud boards =
          FindBoards(world.Sweep(1'000'000'000 + view), world.target(), detection);
      ASSERT_FALSE(boards.candidates.empty()) << lidar << " view " << view << ": " << boards.why;
      const CloudEdges& found = boards.candidates[0];
      const Rigid3& truth = world.lidar_from_target();
      EXPECT_LT((found.centre - truth.translation).norm(), 0.03) << lidar << " view " << view;
      const Eigen::Vector3d normal = truth.rotation * Eigen::Vector3d::UnitZ();
      EXPECT_LT(found.normal.cross(normal).norm(), 0.035) << lidar << " view " << view;
      EXPECT_GE(found.crossings.size(), 20U);
    }
  }
}

TEST(LivoxBoard, IsNotFoundWhereThereIsNone) {
  for (const int lidar : {simulate::kMid360, simulate::kAvia}) {
    simulate::Options options = LivoxPhysics(lidar);
    options.clutter.panel = options.clutter.door = true;
    const simulate::CloudWorld world(options, std::nullopt);
    BoardInCloudOptions detection;
    detection.range_sigma_m = options.livox->range_sigma_m;
    EXPECT_TRUE(
        FindBoards(world.Sweep(1'000'000'000), world.target(), detection).candidates.empty());
  }
}

// As most programs write such clouds.
TEST(LivoxBoard, IsFoundAsWellWithoutTimes) {
  for (int view = 0; view < 4; ++view) {
    const simulate::Options options = LivoxPhysics(simulate::kAvia);
    const simulate::CloudWorld world(options, view);
    BoardInCloudOptions detection;
    detection.range_sigma_m = options.livox->range_sigma_m;
    Cloud cloud = world.Sweep(1'000'000'000 + view);
    const BoardsInCloud with = FindBoards(cloud, world.target(), detection);
    cloud.utime.clear();
    const BoardsInCloud without = FindBoards(cloud, world.target(), detection);
    ASSERT_FALSE(with.candidates.empty()) << view << ": " << with.why;
    ASSERT_FALSE(without.candidates.empty()) << view << ": " << without.why;
    EXPECT_LT((without.candidates[0].centre - with.candidates[0].centre).norm(), 1e-9) << view;
    EXPECT_EQ(without.candidates[0].crossings.size(), with.candidates[0].crossings.size()) << view;
  }
}

// Before the board, a floor as high as its lowest corner: beams below it end on the floor.
TEST(LivoxBoard, IsFoundWhereTheFloorHidesOneSide) {
  simulate::Options options = LivoxPhysics(simulate::kAvia);
  options.pose.max_roll_rad = 0;
  for (int view = 0; view < 4; ++view) {
    const simulate::CloudWorld world(options, view);
    const Rigid3& truth = world.lidar_from_target();
    BoardInCloudOptions detection;
    detection.range_sigma_m = options.livox->range_sigma_m;
    Cloud cloud = world.Sweep(1'000'000'000 + view);
    double lowest = 0;
    for (const Eigen::Vector3d& corner : world.target().OutlineCorners()) {
      lowest = std::min(lowest, (truth * corner).z());
    }
    for (Eigen::Vector3f& p : cloud.points) {
      if (p.z() < lowest) p *= static_cast<float>(lowest) / p.z();
    }
    const BoardsInCloud boards = FindBoards(cloud, world.target(), detection);
    ASSERT_FALSE(boards.candidates.empty()) << view << ": " << boards.why;
    EXPECT_LT((boards.candidates[0].centre - truth.translation).norm(), 0.03) << view;
  }
}

}  // namespace
}  // namespace rgbdt
