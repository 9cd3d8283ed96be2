#include "services/nodes/mount_follower.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/nodes/fuser_node.h"
#include "tests/nodes/nodes_testing.h"
#include "tests/numbers.h"

namespace rgbdt {
namespace {

using test::Only;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

CameraSpec Spec() {
  CameraSpec spec;
  spec.name = "rgb";
  spec.follow = {0.5 * kDegree, 0.02};
  return spec;
}

CameraCalibration Calibrated() {
  CameraCalibration calibration;
  calibration.camera = "rgb";
  calibration.camera_from_lidar.translation = {0.1, 0, 0};
  calibration.status = SolveStatus::kConverged;
  return calibration;
}

MountCheck Check(MountState state, double turned_deg = 0, Utime utime = 100) {
  MountCheck check;
  check.camera = "rgb";
  check.utime = utime;
  check.calibration_utime = 7;
  check.state = state;
  check.moved[1] = turned_deg * kDegree;
  check.camera_from_lidar = Exp(check.moved) * Calibrated().camera_from_lidar;
  check.covariance = 1e-6 * Matrix6d::Identity();
  return check;
}

TEST(MountFollower, FollowsWithinItsLimitsAndSaysSo) {
  MountFollower follower;
  std::string said;
  EXPECT_FALSE(follower.Follow(Spec(), Check(MountState::kMoved, 0.3), &said)) << "no calibration";
  EXPECT_TRUE(follower.Take(Calibrated(), 7));
  EXPECT_FALSE(follower.Follow(Spec(), Check(MountState::kHolds), &said));
  EXPECT_THAT(said, IsEmpty());
  const MountCheck moved = Check(MountState::kMoved, 0.3);
  const auto step = follower.Follow(Spec(), moved, &said);
  ASSERT_TRUE(step);
  EXPECT_EQ(step->utime, 100);
  EXPECT_LT(RotationDistance(step->calibration.camera_from_lidar, moved.camera_from_lidar), 1e-9);
  EXPECT_EQ(*step->calibration.covariance, moved.covariance);
  EXPECT_THAT(said, HasSubstr("0.30 deg"));
  EXPECT_THAT(follower.Text(), HasSubstr("follows the monitor"));
  // Hardly another pose.
  EXPECT_FALSE(follower.Follow(Spec(), Check(MountState::kMoved, 0.305), &said));
  EXPECT_THAT(said, IsEmpty());
  // Too far: it stays where it was.
  EXPECT_FALSE(follower.Follow(Spec(), Check(MountState::kMoved, 0.7), &said));
  EXPECT_THAT(said, HasSubstr("farther than"));
  EXPECT_FALSE(follower.Follow(Spec(), Check(MountState::kLost), &said));
  EXPECT_FALSE(follower.Follow(Spec(), Check(MountState::kCannotTell), &said));
  const auto back = follower.Follow(Spec(), Check(MountState::kHolds), &said);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->utime, 7);
  EXPECT_THAT(said, HasSubstr("holds again"));
  EXPECT_THAT(follower.Text(), IsEmpty());
}

TEST(MountFollower, ARepeatedCalibrationDoesNotPutItBack) {
  MountFollower follower;
  std::string said;
  follower.Take(Calibrated(), 7);
  EXPECT_TRUE(follower.Take(Calibrated(), 7)) << "nothing is followed yet";
  ASSERT_TRUE(follower.Follow(Spec(), Check(MountState::kMoved, 0.3), &said));
  EXPECT_FALSE(follower.Take(Calibrated(), 7));
  EXPECT_TRUE(follower.Take(Calibrated(), 8)) << "a new one";
  EXPECT_FALSE(follower.Follow(Spec(), Check(MountState::kMoved, 0.3), &said)) << "of the old one";
}

TEST(MountFollower, ACalibrationWithAnotherTimingIsNoRepetition) {
  MountFollower follower;
  std::string said;
  follower.Take(Calibrated(), 7);
  ASSERT_TRUE(follower.Follow(Spec(), Check(MountState::kMoved, 0.3), &said));
  CameraCalibration timed = Calibrated();
  timed.timing = CameraTiming{{0.2, 1e-4}, {0, 1e-5}};
  EXPECT_TRUE(follower.Take(timed, 7));
}

TEST(MountFollower, TheFuserFollowsWhereItIsTold) {
  const simulate::Simulator simulator(test::TinyOptions());
  const Rig rig = test::RigOf(simulator);
  for (const auto follow : {FuserNode::Follow::kYes, FuserNode::Follow::kNo}) {
    const bool follows = follow == FuserNode::Follow::kYes;
    FuserNode node(FuserNode::Ranges::kAsMeasured, Use::kIfSound, follow);
    const auto channels = node.Subscriptions();
    EXPECT_EQ(std::count(channels.begin(), channels.end(), "MOUNT_CHECK"), follows ? 1 : 0);
    std::vector<std::string> warnings;
    node.SetWarningHandler([&](const std::string& warning) { warnings.push_back(warning); });
    node.Handle(test::TextOf(rig));
    CalibrationMessage message;
    message.utime = 7;
    message.rig_hash = rig.hash;
    message.calibration = Calibrated();
    node.Handle(message);
    node.Handle(Check(MountState::kMoved, 0.3));
    node.Handle(message);
    CloudChunk chunk;
    chunk.cloud.sweep_utime = 1'000'000;
    chunk.cloud.lines = 1;
    chunk.cloud.beams = 1;
    chunk.cloud.points = {{5, 0, 0}};
    chunk.cloud.intensity = {0.5F};
    chunk.cloud.utime = {1'000'000};
    const RgbdtCloud cloud = Only<RgbdtCloud>(node.Handle(chunk)).at(0);
    EXPECT_EQ(cloud.calibration_utime[0], follows ? 100 : 7);
    EXPECT_EQ(warnings.size(), follows ? 1U : 0U);
    EXPECT_EQ(node.GetStatus().text.find("follows the monitor") != std::string::npos, follows);
  }
}

}  // namespace
}  // namespace rgbdt
