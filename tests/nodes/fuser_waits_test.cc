// Clouds whose poses come after them, as a turned scanner's: fuser_node, chunk_queue.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calib/scan_assembly/sweep_chunks.h"
#include "services/nodes/fuser_node.h"
#include "services/nodes/odometry_node.h"
#include "tests/nodes/nodes_testing.h"
#include "tests/numbers.h"
#include "tests/study/drives.h"

namespace rgbdt {
namespace {

using test::Counter;
using test::Only;
using test::TinyRig;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

StampedPose PoseFrom(Utime utime, double x, const std::string& source = OdometryNode::kSource) {
  StampedPose pose;
  pose.utime = utime;
  pose.source = source;
  pose.map_from_lidar.translation.x() = x;
  return pose;
}

// A tenth of a second of a sweep that began at kNow.
CloudChunk ChunkAt(Utime utime) {
  CloudChunk chunk;
  chunk.cloud.sweep_utime = kNow;
  chunk.cloud.lines = 1;
  chunk.cloud.beams = 2;
  chunk.cloud.points = {{5, 0, 0}, {5, 0.1F, 0}};
  chunk.cloud.utime = {utime, utime + 100'000};
  chunk.cloud.intensity = {0.5F, 0.5F};
  return chunk;
}

class FuserWaits : public ::testing::Test {
 protected:
  FuserWaits() { node_.Handle(test::TextOf(TinyRig())); }
  // 1 m/s along x, told up to `until`.
  Messages Tell(Utime until, const std::string& source = OdometryNode::kSource) {
    Messages all;
    for (; told_ <= until; told_ += 100'000) {
      for (Message& m : node_.Handle(PoseFrom(told_, ToSeconds(told_ - kNow), source))) {
        all.push_back(std::move(m));
      }
    }
    return all;
  }
  FuserNode node_;
  Utime told_ = kNow - kSecond;
};

TEST_F(FuserWaits, AChunkWaitsForThePosesThatOdometryTellsLater) {
  Tell(kNow);
  EXPECT_THAT(node_.Handle(ChunkAt(kNow)), SizeIs(1)) << "poses tell a little ahead";
  EXPECT_THAT(node_.Handle(ChunkAt(kNow + kSecond)), IsEmpty());
  EXPECT_THAT(node_.Handle(ChunkAt(kNow + 2 * kSecond)), IsEmpty());
  EXPECT_EQ(Counter(node_.GetStatus(), "chunks that wait for a pose"), 2);
  EXPECT_THAT(node_.GetStatus().text, HasSubstr("wait for their POSE"));
  const auto fused = Only<RgbdtCloud>(Tell(kNow + 2 * kSecond));
  ASSERT_THAT(fused, SizeIs(2));
  for (int i = 0; i < 2; ++i) {
    const auto at = static_cast<std::size_t>(i);
    EXPECT_EQ(fused[at].utime[0], kNow + (i + 1) * kSecond) << "in the order in which they came";
    ASSERT_TRUE(fused[at].map_from_lidar);
    EXPECT_NEAR(fused[at].map_from_lidar->translation.x(), i + 1, 1e-6);
  }
  EXPECT_EQ(Counter(node_.GetStatus(), "without a pose"), 0);
  EXPECT_EQ(Counter(node_.GetStatus(), "chunks that wait for a pose"), 0);
}

TEST_F(FuserWaits, ImagesOfAllOfTheTimeAreKeptMeanwhile) {
  CalibrationMessage calibration;
  calibration.utime = kNow;
  calibration.rig_hash = TinyRig().hash;
  calibration.calibration.camera = "rgb";
  calibration.calibration.camera_from_lidar =
      test::TinySimulator().truth().camera_from_lidar.at("rgb");
  calibration.calibration.status = SolveStatus::kConverged;
  node_.Handle(calibration);
  Tell(kNow);
  const CameraSpec& camera = TinyRig().Camera("rgb");
  const auto image = [&](Utime utime) {
    Image image;
    image.camera = "rgb";
    image.utime = utime;
    image.format = camera.format;
    image.pixels = cv::Mat(camera.height, camera.width, CV_8UC1, cv::Scalar(100));
    return image;
  };
  node_.Handle(image(kNow));
  node_.Handle(ChunkAt(kNow + kSecond));
  for (Utime utime = kNow + 50'000; utime < kNow + 4 * kSecond; utime += 50'000) {
    node_.Handle(image(utime));
  }
  const auto fused = Only<RgbdtCloud>(Tell(kNow + kSecond));
  ASSERT_THAT(fused, SizeIs(1));
  EXPECT_EQ(Counter(node_.GetStatus(), "without an image of their time"), 0);
}

TEST_F(FuserWaits, NothingWaitsForAnotherSourcesPoses) {
  Tell(kNow, "gps");
  EXPECT_THAT(node_.Handle(ChunkAt(kNow + kSecond)), SizeIs(1));
  EXPECT_EQ(Counter(node_.GetStatus(), "without a pose"), 2);
}

TEST_F(FuserWaits, AnotherSourceThatTakesOverEndsTheWait) {
  Tell(kNow);
  EXPECT_THAT(node_.Handle(ChunkAt(kNow + kSecond)), IsEmpty());
  EXPECT_THAT(node_.Handle(PoseFrom(told_, 0.1, "gps")), SizeIs(1));
}

// The sweep lasts 1.1 s by its first chunk, so that none waits beyond 4.2 s: two more at the end.
TEST_F(FuserWaits, PosesThatDoNotComeAnyMoreAreWaitedForTwoSweeps) {
  Tell(kNow);
  EXPECT_THAT(node_.Handle(ChunkAt(kNow + kSecond)), IsEmpty());
  CloudChunk later = ChunkAt(kNow + 4 * kSecond);
  later.cloud.sweep_utime = kNow + 3 * kSecond;
  EXPECT_THAT(node_.Handle(later), IsEmpty());
  later = ChunkAt(kNow + 5 * kSecond);
  later.cloud.sweep_utime = kNow + 4 * kSecond;
  EXPECT_THAT(node_.Handle(later), SizeIs(3));
  EXPECT_EQ(Counter(node_.GetStatus(), "without a pose"), 6);
}

TEST_F(FuserWaits, WhereNothingComesAnyMoreTheLastGoOut) {
  node_.Advance(5 * kSecond);
  Tell(kNow);
  EXPECT_THAT(node_.Handle(ChunkAt(kNow + kSecond)), IsEmpty());
  EXPECT_THAT(node_.Advance(10 * kSecond), IsEmpty());
  EXPECT_THAT(node_.Advance(14 * kSecond), IsEmpty());
  EXPECT_THAT(node_.Advance(15 * kSecond), SizeIs(1));
  EXPECT_THAT(node_.Handle(ChunkAt(kNow + kSecond + 100'000)), SizeIs(1)) << "nor does the next";
  node_.Advance(15 * kSecond);
  EXPECT_THAT(node_.Handle(ChunkAt(kNow + kSecond + 200'000)), IsEmpty()) << "clouds are back";
}

TEST_F(FuserWaits, AClockThatIsSetBackEndsTheWait) {
  Tell(kNow);
  EXPECT_THAT(node_.Handle(ChunkAt(kNow + kSecond)), IsEmpty());
  CloudChunk before = ChunkAt(kNow - 3600 * kSecond);
  before.cloud.sweep_utime = kNow - 3600 * kSecond;
  EXPECT_THAT(node_.Handle(before), SizeIs(2));
}

TEST_F(FuserWaits, APoseThatComesAgainLeavesTheNewestWhereItIs) {
  Tell(kNow + 2 * kSecond);
  node_.Handle(PoseFrom(kNow, 0));
  EXPECT_THAT(node_.Handle(ChunkAt(kNow + kSecond)), SizeIs(1));
}

TEST_F(FuserWaits, SoManyPointsAndNoMoreWait) {
  Tell(kNow);
  CloudChunk large = ChunkAt(kNow + kSecond);
  const std::size_t size = ChunkQueue::kMostPoints / 2 - 1;
  large.cloud.beams = static_cast<int>(size);
  large.cloud.points.assign(size, {5, 0, 0});
  large.cloud.utime.assign(size, kNow + kSecond);
  large.cloud.intensity.assign(size, 0.5F);
  EXPECT_THAT(node_.Handle(large), IsEmpty());
  EXPECT_THAT(node_.Handle(large), IsEmpty());
  EXPECT_EQ(Counter(node_.GetStatus(), "chunks that wait for a pose"), 2);
  node_.Handle(ChunkAt(kNow + kSecond));
  node_.Handle(ChunkAt(kNow + kSecond));
  EXPECT_LE(Counter(node_.GetStatus(), "chunks that wait for a pose"), 3);
  EXPECT_GT(Counter(node_.GetStatus(), "without a pose"), 0);
}

// The whole: a turned scanner's rig that drives, with nothing else on the bus.
TEST_F(FuserWaits, ATurnedScannersDriveIsPlacedLive) {
  study::TurningDrive drive(5, study::QuickScanner(), 0.4);
  OdometryNode odometry;
  std::vector<RgbdtCloud> fused;
  Utime first = 0;
  for (int i = 0; i < 3; ++i) {
    for (const CloudChunk& chunk : SplitSweep(drive.Sweep(i))) {
      Messages answers = node_.Handle(chunk);
      for (const StampedPose& pose : Only<StampedPose>(odometry.Handle(chunk))) {
        if (first == 0) first = pose.utime;
        for (Message& m : node_.Handle(pose)) answers.push_back(std::move(m));
      }
      for (RgbdtCloud& cloud : Only<RgbdtCloud>(answers)) fused.push_back(std::move(cloud));
    }
  }
  std::size_t placed = 0;
  const Rigid3 start = drive.At(first);
  for (const RgbdtCloud& cloud : fused) {
    if (!cloud.map_from_lidar) continue;
    placed += cloud.size();
    const Rigid3 found = start * *cloud.map_from_lidar;
    EXPECT_LT((found.translation - drive.At(cloud.frame_utime).translation).norm(), 0.05);
  }
  // All of the sweep that was driven through and whose successor has come; of both drives alike.
  const std::size_t sweep = HitsOf(drive.Sweep(1)).size();
  EXPECT_GT(placed, 3 * sweep / 2);
  EXPECT_EQ(Counter(node_.GetStatus(), "without a pose"), 0);
}

}  // namespace
}  // namespace rgbdt
