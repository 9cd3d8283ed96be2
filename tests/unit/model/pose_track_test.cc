#include "calib/model/pose_track.h"

#include "tests/numbers.h"
#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

// A rig that drives a bend: 2 m/s, 0.5 rad/s.
StampedPose Driven(Utime utime) {
  const double t = ToSeconds(utime - kNow);
  StampedPose pose;
  pose.utime = utime;
  pose.source = "test";
  Vector6d twist;
  twist << 0, 0, 0.5, 2, 0, 0;
  pose.map_from_lidar = Exp(t * twist);
  return pose;
}

TEST(PoseTrack, NothingHeardNothingKnown) {
  EXPECT_TRUE(PoseTrack().empty());
  EXPECT_FALSE(PoseTrack().At(kNow));
}

TEST(PoseTrack, OnePoseIsARigThatStands) {
  PoseTrack track;
  track.Add(Driven(kNow + kSecond));
  for (const Utime t : {kNow - 100 * kSecond, kNow, kNow + 100 * kSecond}) {
    ASSERT_TRUE(track.At(t));
    EXPECT_LT(CentreDistance(*track.At(t), Driven(kNow + kSecond).map_from_lidar), 1e-12);
  }
}

TEST(PoseTrack, BetweenPosesItFollowsTheBend) {
  PoseTrack track;
  for (int i = 0; i <= 10; ++i)
    EXPECT_EQ(track.Add(Driven(kNow + i * 100'000)), PoseTrack::Added::kYes);
  // And a little ahead of the newest.
  for (const Utime t : {0, 1, 50'000, 99'999, 100'000, 777'777, 1'000'000, 1'150'000}) {
    const auto at = track.At(kNow + t);
    ASSERT_TRUE(at) << t;
    const Rigid3 truth = Driven(kNow + t).map_from_lidar;
    EXPECT_LT((at->translation - truth.translation).norm(), 1e-9) << t;
    EXPECT_LT(RotationDistance(*at, truth), 1e-9) << t;
  }
}

TEST(PoseTrack, BeforeItsStartFarAheadAndAcrossAGapNothingIsKnown) {
  PoseTrack track;
  track.Add(Driven(kNow));
  track.Add(Driven(kNow + 100'000));
  track.Add(Driven(kNow + 100'000 + PoseTrack::kGap + 1));
  track.Add(Driven(kNow + 300'000 + PoseTrack::kGap));
  EXPECT_FALSE(track.At(kNow - 1));
  EXPECT_TRUE(track.At(kNow + 100'000));
  EXPECT_FALSE(track.At(kNow + 150'000));
  EXPECT_TRUE(track.At(kNow + 200'000 + PoseTrack::kGap));
  EXPECT_TRUE(track.At(kNow + 300'000 + PoseTrack::kGap + PoseTrack::kAhead));
  EXPECT_FALSE(track.At(kNow + 300'000 + PoseTrack::kGap + PoseTrack::kAhead + 1));
}

TEST(PoseTrack, WhatComesLateIsNotTaken) {
  PoseTrack track;
  track.Add(Driven(kNow + 100'000));
  EXPECT_EQ(track.Add(Driven(kNow + 100'000)), PoseTrack::Added::kOld);
  EXPECT_EQ(track.Add(Driven(kNow)), PoseTrack::Added::kOld);
}

TEST(PoseTrack, AJumpBeginsAnew) {
  PoseTrack track;
  track.Add(Driven(kNow));
  track.Add(Driven(kNow + 100'000));
  StampedPose far = Driven(kNow + 200'000);
  far.map_from_lidar.translation.x() += 20;
  EXPECT_EQ(track.Add(far), PoseTrack::Added::kJump);
  EXPECT_EQ(track.Add(Driven(kNow + 50 * kSecond)), PoseTrack::Added::kYes);  // far, but in time
  EXPECT_EQ(track.Add(Driven(kNow)), PoseTrack::Added::kJump) << "the clock was set back";
  StampedPose turned = Driven(kNow + 100'000);
  turned.map_from_lidar = turned.map_from_lidar * RotationAbout(Eigen::Vector3d::UnitZ(), 2);
  EXPECT_EQ(track.Add(turned), PoseTrack::Added::kJump);
  ASSERT_TRUE(track.At(kNow));
  EXPECT_LT(RotationDistance(*track.At(kNow), turned.map_from_lidar), 1e-12);
}

}  // namespace
}  // namespace rgbdt
