// Ring numbers that are not those of the LIDAR's rings, and rings that are no exact cones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <functional>
#include <optional>
#include <string>

#include "calib/detect/cloud/board_in_cloud.h"
#include "calib/detect/cloud/range_grid.h"
#include "calib/simulate/internal/cloud_world.h"
#include "tests/simulated_variants.h"

namespace rgbdt {
namespace {

using testing::HasSubstr;
using testing::Not;

simulate::Options NumberedPhysics(int rings) {
  simulate::Options options;
  options.seed = 3;
  simulate::UseLidar(rings, &options);
  options.pose.min_range_m = 2.4;
  options.pose.max_range_m = rings == 16 ? 4 : 5;
  return options;
}

// A constant, and the place in a packet or the laser of a group, as some drivers have it.
TEST(RingNumbers, ThatSayNothingAreLeftOut) {
  for (const int rings : {16, 64}) {
    const simulate::CloudWorld world(NumberedPhysics(rings), 1);
    BoardInCloudOptions options;
    options.range_sigma_m = 0.02;
    Cloud cloud = simulate::Unorganised(world.Sweep(1'000'000'000), true);
    const std::vector<std::uint16_t> right = cloud.ring;
    cloud.ring.clear();
    const BoardsInCloud without = FindBoards(cloud, world.target(), options);
    ASSERT_FALSE(without.candidates.empty()) << rings << ": " << without.why;
    for (const int numbers : {1, 2, 4, rings / 2}) {
      const std::string what = std::to_string(rings) + " rings, numbers " + std::to_string(numbers);
      cloud.ring.clear();
      for (const std::uint16_t ring : right) {
        cloud.ring.push_back(static_cast<std::uint16_t>(ring % numbers));
      }
      EXPECT_TRUE(RangeGrid(cloud).misnumbered()) << what;
      EXPECT_EQ(RangeGrid(cloud).rows(), rings) << what;
      const BoardsInCloud boards = FindBoards(cloud, world.target(), options);
      ASSERT_FALSE(boards.candidates.empty()) << what << ": " << boards.why;
      const CloudEdges& a = without.candidates[0];
      const CloudEdges& b = boards.candidates[0];
      EXPECT_EQ(a.centre, b.centre) << what;
      EXPECT_EQ(a.pose->covariance, b.pose->covariance) << what;
      EXPECT_EQ(a.groups.size(), b.groups.size()) << what;
    }
  }
}

/// How a LIDAR's beams do not meet in one point.
struct Unlike {
  const char* name;
  std::function<Eigen::Vector3f(const Eigen::Vector3f& p, int ring)> moved;
};

TEST(RingNumbers, OfRingsThatAreNoExactConesAreUsed) {
  const Unlike kUnlike[] = {
      {"one point", [](const Eigen::Vector3f& p, int) { return p; }},
      // Two blocks of lasers above each other, both above the origin (HDL-64).
      {"blocks",
       [](const Eigen::Vector3f& p, int ring) -> Eigen::Vector3f {
         return p + Eigen::Vector3f(0, 0, ring % 64 < 32 ? 0.12F : 0.21F);
       }},
      {"beside the axis",
       [](const Eigen::Vector3f& p, int) -> Eigen::Vector3f {
         return p + 0.05F * Eigen::Vector3f(p.x(), p.y(), 0).normalized();
       }},
      {"tilted",
       [](const Eigen::Vector3f& p, int) -> Eigen::Vector3f {
         return Eigen::AngleAxisf(0.3F, Eigen::Vector3f::UnitY()) * p;
       }},
  };
  for (const int rings : {16, 32, 64, 128}) {
    const simulate::CloudWorld world(NumberedPhysics(rings), 1);
    for (const Unlike& unlike : kUnlike) {
      Cloud cloud = simulate::Unorganised(world.Sweep(1'000'000'000), true);
      for (std::size_t i = 0; i < cloud.size(); ++i) {
        cloud.points[i] = unlike.moved(cloud.points[i], cloud.ring[i]);
      }
      EXPECT_FALSE(RangeGrid(cloud).misnumbered()) << rings << ' ' << unlike.name;
    }
  }
}

// Beams that meet farther above the origin than rings tell apart (RS-Bpearl): without numbers
// nothing tells its rings.
TEST(RingNumbers, ThatAreMissedAreAskedFor) {
  const auto why = [](const Cloud& cloud, const Target& target) {
    const BoardsInCloud boards = FindBoards(cloud, target);
    EXPECT_TRUE(boards.candidates.empty());
    return boards.why;
  };
  const auto raised = [](Cloud cloud) {
    for (Eigen::Vector3f& p : cloud.points) p.z() += 0.8F;
    return cloud;
  };
  const simulate::CloudWorld spinning(NumberedPhysics(16), std::nullopt);
  const Cloud numbered = simulate::Unorganised(spinning.Sweep(1'000'000'000), true);
  Cloud bare = numbered;
  bare.ring.clear();
  EXPECT_THAT(why(raised(bare), spinning.target()), HasSubstr("no field `ring`"));
  EXPECT_THAT(why(raised(numbered), spinning.target()), Not(HasSubstr("`ring`")));
  EXPECT_THAT(why(bare, spinning.target()), Not(HasSubstr("`ring`"))) << "exact cones";
  for (const int lidar : {simulate::kMid360, simulate::kAvia}) {
    simulate::Options options;
    simulate::UseLidar(lidar, &options);
    const simulate::CloudWorld world(options, std::nullopt);
    Cloud cloud = world.Sweep(1'000'000'000);
    cloud.ring.clear();
    EXPECT_THAT(why(cloud, world.target()), Not(HasSubstr("`ring`"))) << lidar;
  }
}

}  // namespace
}  // namespace rgbdt
