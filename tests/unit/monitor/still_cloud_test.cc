#include "calib/monitor/still_cloud.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/numbers.h"

namespace rgbdt {
namespace {

// 5 m/s and half a radian a second.
Rigid3 MapFromRig(Utime utime) {
  Vector6d twist;
  twist << 0, 0, 0.5, 5, 0, 0;
  return Exp(Vector6d(ToSeconds(utime - kNow) * twist));
}

PoseTrack Driven() {
  PoseTrack poses;
  for (int i = -5; i <= 15; ++i) {
    StampedPose pose;
    pose.utime = kNow + i * kSecond / 10;
    pose.source = "test";
    pose.map_from_lidar = MapFromRig(pose.utime);
    poses.Add(pose);
  }
  return poses;
}

// A tenth of a second's sweep past points of the map, one beam in five a miss.
struct Sweep {
  Cloud cloud;
  std::vector<Eigen::Vector3d> map;  // where each point or direction is
};

Sweep Swept() {
  Sweep sweep;
  sweep.cloud.sweep_utime = kNow;
  sweep.cloud.lines = 4;
  sweep.cloud.beams = 25;
  for (int i = 0; i < 100; ++i) {
    const Utime utime = kNow + i * kSecond / 1000;
    const Eigen::Vector3d at(8 * std::cos(0.06 * i), 8 * std::sin(0.06 * i), 0.01 * i);
    const bool is_miss = i % 5 == 2;
    const Rigid3 rig_from_map = MapFromRig(utime).Inverse();
    const Eigen::Vector3f nan = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
    const Eigen::Vector3d direction = at.normalized();
    sweep.map.push_back(is_miss ? direction : at);
    sweep.cloud.points.push_back(is_miss ? nan : (rig_from_map * at).cast<float>().eval());
    sweep.cloud.directions.push_back((rig_from_map.rotation * direction).cast<float>());
    sweep.cloud.utime.push_back(utime);
  }
  return sweep;
}

TEST(AsSeenAt, PutsPointsWhereTheyWouldHaveBeenSeen) {
  const Sweep sweep = Swept();
  const Utime moment = kNow + kSecond / 20;
  const auto still = AsSeenAt(sweep.cloud, Driven(), moment);
  ASSERT_TRUE(still);
  const Rigid3 moment_from_map = MapFromRig(moment).Inverse();
  for (std::size_t i = 0; i < sweep.map.size(); ++i) {
    ASSERT_EQ(still->IsHit(i), sweep.cloud.IsHit(i));
    if (still->IsHit(i)) {
      const Eigen::Vector3d wanted = moment_from_map * sweep.map[i];
      EXPECT_LT((still->points[i].cast<double>() - wanted).norm(), 1e-3) << i;
      EXPECT_GT((sweep.cloud.points[i] - still->points[i]).norm(), i == 50 ? -1 : 1e-3) << i;
    } else {
      const Eigen::Vector3d wanted = moment_from_map.rotation * sweep.map[i];
      EXPECT_LT((still->directions[i].cast<double>() - wanted).norm(), 1e-3) << i;
    }
  }
}

TEST(AsSeenAt, WithoutPosesTheRigStands) {
  const Sweep sweep = Swept();
  const auto still = AsSeenAt(sweep.cloud, PoseTrack(), kNow);
  ASSERT_TRUE(still);
  EXPECT_EQ(still->points[0], sweep.cloud.points[0]);
}

TEST(AsSeenAt, NothingWhereThePosesDoNotTell) {
  Sweep sweep = Swept();
  EXPECT_FALSE(AsSeenAt(sweep.cloud, Driven(), kNow + 60 * kSecond)) << "the image's moment";
  for (Utime& utime : sweep.cloud.utime) utime += 60 * kSecond;
  EXPECT_FALSE(AsSeenAt(sweep.cloud, Driven(), kNow)) << "the points' times";
  sweep = Swept();
  sweep.cloud.utime[7] += 60 * kSecond;  // a single one
  const auto still = AsSeenAt(sweep.cloud, Driven(), kNow);
  ASSERT_TRUE(still);
  EXPECT_FALSE(still->IsHit(7));
  EXPECT_TRUE(std::isnan(still->directions[7].x()));
  EXPECT_TRUE(still->IsHit(8));
}

}  // namespace
}  // namespace rgbdt
