#include "services/nodes/odometry_node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "calib/model/pose_track.h"
#include "calib/scan_assembly/sweep_chunks.h"
#include "tests/nodes/nodes_testing.h"
#include "tests/nodes/twins.h"
#include "tests/study/drives.h"

namespace rgbdt {
namespace {

using study::Drive;
using study::DriveScene;
using test::Counter;
using test::Only;
using test::Twins;
using ::testing::Each;
using ::testing::Gt;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// A quarter of the columns.
simulate::SpinningOptions Lidar() {
  simulate::SpinningOptions lidar = simulate::SpinningLidar(32);
  lidar.azimuth_step_rad *= 4;
  return lidar;
}

Drive Street() { return {DriveScene::kStreet, 4, Lidar(), study::StreetWay(4, 5)}; }

// As it travels: some rings, then the others and the end.
Messages ChunksOf(const Cloud& sweep) {
  CloudChunk low, high;
  const std::size_t half = sweep.size() / 2;
  for (CloudChunk* chunk : {&low, &high}) {
    Cloud& cloud = chunk->cloud;
    cloud.sweep_utime = sweep.sweep_utime;
    cloud.lines = sweep.lines / 2;
    cloud.beams = sweep.beams;
    const std::size_t first = chunk == &low ? 0 : half;
    const auto part = [&](const auto& all) {
      const auto begin = all.begin() + static_cast<std::ptrdiff_t>(first);
      return std::decay_t<decltype(all)>(begin, begin + static_cast<std::ptrdiff_t>(half));
    };
    cloud.points = part(sweep.points);
    cloud.directions = part(sweep.directions);
    cloud.intensity = part(sweep.intensity);
    cloud.utime = part(sweep.utime);
    cloud.ring = part(sweep.ring);
  }
  high.cloud.first_line = sweep.lines / 2;
  high.sweep_end = true;
  high.sweep_lines = sweep.lines;
  low.seq = 0;
  high.seq = 1;
  return {low, high};
}

TEST(OdometryNode, SaysWhereTheRigIsAfterEachSweep) {
  OdometryNode node;
  EXPECT_THAT(node.GetStatus().text, HasSubstr("waits for sweeps"));
  Drive drive = Street();
  std::vector<StampedPose> poses;
  std::vector<SweepOdometry> told;
  for (int i = 0; i < 8; ++i) {
    const Messages chunks = ChunksOf(drive.Sweep(i));
    EXPECT_THAT(node.Handle(chunks[0]), IsEmpty()) << "a sweep is taken at its end";
    const Messages answers = node.Handle(chunks[1]);
    for (const auto& pose : Only<StampedPose>(answers)) poses.push_back(pose);
    for (const auto& odometry : Only<SweepOdometry>(answers)) told.push_back(odometry);
    EXPECT_THAT(node.Handle(chunks[1]), IsEmpty()) << "and once";
  }
  // The first sweep tells nothing of its motion; of the second its middle, too.
  ASSERT_EQ(poses.size(), 8U);
  EXPECT_EQ(poses[0].source, "odometry");
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(poses[i].seq, static_cast<std::int64_t>(i));
    const Rigid3 moved = poses[0].map_from_lidar.Inverse() * poses[i].map_from_lidar;
    const Rigid3 truth = drive.At(poses[0].utime).Inverse() * drive.At(poses[i].utime);
    EXPECT_LT((moved.translation - truth.translation).norm(), 0.05);
    EXPECT_LT(RotationDistance(moved, truth), 0.005);
  }
  ASSERT_EQ(told.size(), 8U) << "one a sweep, placed or not";
  EXPECT_FALSE(told[0].placed);
  for (std::size_t i = 1; i < told.size(); ++i) {
    EXPECT_TRUE(told[i].placed);
    EXPECT_EQ(told[i].seq, static_cast<std::int64_t>(i));
    EXPECT_THAT(told[i].untold, IsEmpty());
    const Utime middle = drive.Sweep(static_cast<int>(i)).utime.front() + 50'000;
    const Rigid3 in_a_millisecond = drive.At(middle).Inverse() * drive.At(middle + 1000);
    EXPECT_NEAR(told[i].velocity.tail<3>().norm(), 1e3 * in_a_millisecond.translation.norm(), 0.1)
        << i;
    // Within what it states, of the position: chi-square of 3 beyond 30 is one in a million.
    const Rigid3 moved = told[1].map_from_lidar.Inverse() * told[i].map_from_lidar;
    const Rigid3 truth = drive.At(told[1].utime).Inverse() * drive.At(told[i].utime);
    const Eigen::Vector3d off = (moved.Inverse() * truth).translation;
    const Eigen::Matrix3d sum = (told[1].covariance + told[i].covariance).bottomRightCorner<3, 3>();
    EXPECT_LT(off.dot(sum.ldlt().solve(off)), 30) << i;
  }
  EXPECT_EQ(told.back().utime, poses.back().utime);
  EXPECT_EQ(told.back().map_from_lidar.translation, poses.back().map_from_lidar.translation);
  const Status status = node.GetStatus();
  EXPECT_THAT(status.text, HasSubstr("m/s"));
  EXPECT_EQ(Counter(status, "sweeps"), 8);
  EXPECT_EQ(Counter(status, "poses"), 8);
  EXPECT_EQ(Counter(status, "without a place"), 1);
}

TEST(OdometryNode, SaysWhereATurnedScannersRigStoodForASweep) {
  simulate::ScannerOptions scanner = simulate::FullTurnScanner();
  scanner.motor_speed_rad_s *= 8;
  const study::Stops stops(5, scanner, 1);
  OdometryNode node;
  for (int i = 0; i < 2; ++i) {
    const Cloud sweep = stops.Sweep(i);
    std::vector<StampedPose> poses;
    for (const CloudChunk& chunk : SplitSweep(sweep)) {
      for (const auto& pose : Only<StampedPose>(node.Handle(chunk))) poses.push_back(pose);
    }
    ASSERT_GT(poses.size(), 4U) << i;
    EXPECT_LT(poses[0].utime, sweep.sweep_utime + 100'000);
    EXPECT_GT(poses.back().utime, poses[0].utime + 2'000'000);
    for (std::size_t k = 1; k < poses.size(); ++k) {
      EXPECT_LE(poses[k].utime - poses[k - 1].utime, PoseTrack::kGap / 2)
          << "a track of them holds";
    }
    for (const StampedPose& pose : poses) {
      const Rigid3 truth = stops.At(0).Inverse() * stops.At(i);
      EXPECT_LT((pose.map_from_lidar.translation - truth.translation).norm(), 0.02);
      EXPECT_LT(RotationDistance(pose.map_from_lidar, truth), 0.005);
    }
  }
  EXPECT_THAT(node.GetStatus().text, HasSubstr("stop 2"));
}

// The sweeps' ways end where the next one's begin: no pose is told twice.
TEST(OdometryNode, SaysTheWayThatATurnedScannersRigDroveDuringASweep) {
  study::TurningDrive drive(5, study::QuickScanner(), 0.4);
  OdometryNode node;
  std::vector<StampedPose> poses;
  for (int i = 0; i < 3; ++i) {
    for (const CloudChunk& chunk : SplitSweep(drive.Sweep(i))) {
      for (const auto& pose : Only<StampedPose>(node.Handle(chunk))) poses.push_back(pose);
    }
  }
  ASSERT_GT(poses.size(), 50U);
  const Rigid3 start = drive.At(poses[0].utime);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    EXPECT_GT(poses[i].utime, poses[i - 1].utime);
    const Rigid3 found = start * poses[i].map_from_lidar;
    EXPECT_LT((found.translation - drive.At(poses[i].utime).translation).norm(), 0.03) << i;
    EXPECT_LT(ToSeconds(poses[i].utime - poses[i - 1].utime), 0.6) << i;
  }
  EXPECT_THAT(node.GetStatus().text, HasSubstr("0.4 m/s"));
}

TEST(OdometryNode, SaysWhatIsNotTold) {
  OdometryNode node;
  std::vector<std::string> warnings;
  node.SetWarningHandler([&](const std::string& warning) { warnings.push_back(warning); });
  Drive drive(DriveScene::kPlain, 1, Lidar(), study::StreetWay(1, 5));
  SweepOdometry told;
  for (int i = 0; i < 4; ++i) {
    const auto answers = Only<SweepOdometry>(test::HandleAll(&node, ChunksOf(drive.Sweep(i))));
    ASSERT_EQ(answers.size(), 1U);
    told = answers[0];
  }
  EXPECT_THAT(told.untold, ::testing::Contains(HasSubstr("a turn about the LIDAR's z (yaw)")));
  const Vector6d variances = told.covariance.diagonal();
  EXPECT_GT(variances[2], 100 * variances[0]) << "what is told is known better";
  EXPECT_THAT(node.GetStatus().text, HasSubstr("a turn about the LIDAR's z (yaw)"));
  EXPECT_EQ(Counter(node.GetStatus(), "degenerate"), 3);
  ASSERT_EQ(warnings.size(), 1U) << "told once";
  EXPECT_THAT(warnings[0], HasSubstr("not told by what stands about"));
}

TEST(OdometryNode, ABlindSweepGivesNoPose) {
  OdometryNode node;
  Drive drive = Street();
  for (int i = 0; i < 3; ++i) test::HandleAll(&node, ChunksOf(drive.Sweep(i)));
  Cloud blind = drive.Sweep(3);
  for (Eigen::Vector3f& p : blind.points) {
    p.setConstant(std::numeric_limits<float>::quiet_NaN());
  }
  const Messages answers = test::HandleAll(&node, ChunksOf(blind));
  EXPECT_THAT(Only<StampedPose>(answers), IsEmpty());
  ASSERT_EQ(Only<SweepOdometry>(answers).size(), 1U);
  EXPECT_FALSE(Only<SweepOdometry>(answers)[0].placed);
  EXPECT_THAT(node.GetStatus().text, HasSubstr("0 points of use"));
  EXPECT_EQ(Only<StampedPose>(test::HandleAll(&node, ChunksOf(drive.Sweep(4)))).size(), 2U);
}

TEST(OdometryNode, IsAsIfWhatItRefusesHadNeverCome) {
  OdometryNode node, twin;
  Twins twins(&node, &twin);
  Drive drive = Street();
  // Ends the sweep that is under way, with times of another.
  CloudChunk stray = std::get<CloudChunk>(ChunksOf(drive.Sweep(2))[1]);
  for (Utime& utime : stray.cloud.utime) utime = std::numeric_limits<Utime>::max();
  CloudChunk slow = std::get<CloudChunk>(ChunksOf(drive.Sweep(3))[1]);
  slow.cloud.utime.back() += kMicrosecondsPerSecond;
  twins.bad = {stray, slow};
  for (int i = 0; i < 5; ++i) twins.Feed(ChunksOf(drive.Sweep(i)));
  EXPECT_THAT(twins.refused, Each(Gt(1)));
  EXPECT_EQ(Counter(node.GetStatus(), "poses"), 5);
}

}  // namespace
}  // namespace rgbdt
