// Clouds of a second of LIDARs whose pattern does not repeat, without rings.
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace rgbdt
