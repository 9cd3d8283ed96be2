#include "services/nodes/fuser_node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "services/messages/codec.h"
#include "tests/nodes/nodes_testing.h"
#include "tests/numbers.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using test::Counter;
using test::ErrorOf;
using test::Only;
using test::TinyRig;
using ::testing::HasSubstr;

Image Plain(const std::string& name, Utime utime, int value) {
  const CameraSpec& camera = TinyRig().Camera(name);
  Image image;
  image.camera = name;
  image.utime = utime;
  image.format = camera.format;
  image.pixels =
      cv::Mat(camera.height, camera.width, camera.kind == CameraKind::kThermal ? CV_16UC1 : CV_8UC1,
              cv::Scalar(value));
  return image;
}

CalibrationMessage Calibrated(const std::string& camera) {
  CalibrationMessage message;
  message.utime = kNow - 10 * kSecond;
  message.rig_hash = TinyRig().hash;
  message.method = "paper";
  message.calibration.camera = camera;
  message.calibration.camera_from_lidar =
      test::TinySimulator().truth().camera_from_lidar.at(camera);
  message.calibration.status = SolveStatus::kConverged;
  return message;
}

// Points straight ahead, one every 10 ms, and one behind.
CloudChunk Chunk(Utime utime, int points = 3) {
  CloudChunk chunk;
  chunk.cloud.sweep_utime = kNow;
  chunk.cloud.lines = 1;
  chunk.cloud.beams = points + 1;
  for (int i = 0; i <= points; ++i) {
    chunk.cloud.points.emplace_back(i == points ? -5.0F : 5.0F, 0.01F * static_cast<float>(i), 0);
    chunk.cloud.utime.push_back(utime + i * 10'000);
  }
  chunk.cloud.intensity.assign(chunk.cloud.points.size(), 0.5F);
  return chunk;
}

class FuserNodeTest : public ::testing::Test {
 protected:
  FuserNodeTest() { node_.Handle(test::TextOf(TinyRig())); }
  RgbdtCloud FuseAt(Utime utime) { return Only<RgbdtCloud>(node_.Handle(Chunk(utime))).at(0); }
  FuserNode node_;
};

TEST_F(FuserNodeTest, WithoutACalibrationNoColour) {
  node_.Handle(Plain("rgb", kNow, 100));
  const RgbdtCloud cloud = FuseAt(kNow + kSecond);
  EXPECT_EQ(cloud.size(), 4U);
  EXPECT_EQ(cloud.calibration_utime, (std::vector<Utime>{0, 0}));
  for (const std::uint32_t valid : cloud.valid) EXPECT_EQ(valid, 0U);
  EXPECT_THAT(node_.GetStatus().text, HasSubstr("no calibration yet"));
}

TEST_F(FuserNodeTest, ColoursWhatACameraSees) {
  node_.Handle(Calibrated("rgb"));
  node_.Handle(Calibrated("thermal"));
  node_.Handle(Plain("rgb", kNow, 100));
  node_.Handle(Plain("thermal", kNow, 3000));
  const RgbdtCloud cloud = FuseAt(kNow + kSecond);
  EXPECT_EQ(cloud.calibration_utime, (std::vector<Utime>(2, kNow - 10 * kSecond)));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(cloud.valid[i], 3U);
    EXPECT_EQ(cloud.rgb[i][1], 100);
    EXPECT_EQ(cloud.thermal_counts[i], 3000);
    EXPECT_GT(cloud.temperature_k[i], 250);
  }
  EXPECT_EQ(cloud.valid[3], 0U) << "behind the cameras";
  EXPECT_EQ(Counter(node_.GetStatus(), "points"), 4);
  EXPECT_EQ(Counter(node_.GetStatus(), "coloured"), 3);
  EXPECT_EQ(node_.GetStatus().text, "fusing");
}

TEST_F(FuserNodeTest, ALargeChunkLeavesInMessagesThatFitTheBus) {
  CloudChunk chunk = Chunk(kNow + kSecond);
  const std::size_t points = 2 * SweepFuser::kPartPoints + 5;
  chunk.cloud.points.assign(points, {5, 0, 0});
  chunk.cloud.utime.assign(points, kNow + kSecond);
  chunk.cloud.intensity.assign(points, 0.5F);
  chunk.cloud.beams = static_cast<int>(points);
  chunk.sweep_end = true;
  std::vector<RgbdtCloud> parts;
  for (const RgbdtCloud& cloud : Only<RgbdtCloud>(node_.Handle(chunk))) {
    EXPECT_LT(Encode(cloud).size(), 3'000'000U);
    if (!cloud.whole_sweep) parts.push_back(cloud);
  }
  ASSERT_EQ(parts.size(), 3U);
  EXPECT_EQ(parts[0].size() + parts[1].size() + parts[2].size(), points);
  EXPECT_FALSE(parts[0].sweep_end || parts[1].sweep_end);
  EXPECT_TRUE(parts[2].sweep_end);
  EXPECT_EQ(parts[2].cameras, parts[0].cameras);
}

TEST_F(FuserNodeTest, AnImageServesFromItsTimePlusReadout) {
  node_.Handle(Calibrated("rgb"));
  node_.Handle(Plain("rgb", kNow, 100));
  node_.Handle(Plain("rgb", kNow + kSecond, 200));  // heard early: the future waits
  const Utime readout = FromSeconds(TinyRig().Camera("rgb").readout_s);
  ASSERT_GT(readout, 20'000);
  const RgbdtCloud cloud = FuseAt(kNow + kSecond + readout - 15'000);
  EXPECT_EQ(cloud.rgb[0][1], 100);
  EXPECT_EQ(cloud.rgb[1][1], 100);
  EXPECT_EQ(cloud.rgb[2][1], 200);
}

TEST_F(FuserNodeTest, ImagesOutOfOrderGiveTheSame) {
  FuserNode other;
  other.Handle(test::TextOf(TinyRig()));
  other.Handle(Calibrated("rgb"));
  node_.Handle(Calibrated("rgb"));
  const Messages images = {Plain("rgb", kNow, 100), Plain("rgb", kNow + kSecond / 2, 200)};
  test::HandleAll(&node_, images);
  test::HandleAll(&other, {images[1], images[0]});
  const Message chunk = Chunk(kNow + kSecond / 2 + 20'000);
  EXPECT_EQ(test::BytesOf(node_.Handle(chunk)), test::BytesOf(other.Handle(chunk)));
}

TEST_F(FuserNodeTest, ACalibrationOfAnotherRigIsRefused) {
  CalibrationMessage other = Calibrated("rgb");
  other.rig_hash = "0123456789abcdef";
  EXPECT_THAT(ErrorOf([&] { node_.Handle(other); }),
              ::testing::AllOf(HasSubstr("0123456789abcdef"), HasSubstr(TinyRig().hash)));
  CalibrationMessage stranger = Calibrated("rgb");
  stranger.calibration.camera = "front";
  EXPECT_THAT(ErrorOf([&] { node_.Handle(stranger); }), HasSubstr("front"));
  EXPECT_THAT(node_.GetStatus().text, HasSubstr("no calibration yet"));
}

RigText RigTextOf(const std::string& text) { return {0, HashOfRigText(text), text}; }

RigText Commented(const Rig& rig) { return RigTextOf("# moved\n" + rig.text); }

// A calibration names its rig by a hash only; of the rig that was heard before, it is known.
TEST_F(FuserNodeTest, OfTheRigBeforeWhatDiffersIsKnown) {
  node_.Handle(Commented(TinyRig()));
  node_.Handle(Calibrated("rgb"));
  EXPECT_EQ(node_.GetStatus().text, "fusing") << "only a comment differs";
  Rig other = TinyRig();
  other.cameras[0].lens.fx += 10;
  node_.Handle(test::TextOf(TinyRig()));
  node_.Handle(RigTextOf(PrintRig(other)));
  EXPECT_THAT(ErrorOf([&] { node_.Handle(Calibrated("rgb")); }),
              ::testing::AllOf(HasSubstr("camera rgb: pinhole.fx: "), HasSubstr("--anyway")));
  EXPECT_THAT(node_.GetStatus().text, HasSubstr("no calibration yet"));
}

CalibrationMessage NotToBeUsed() {
  CalibrationMessage message = Calibrated("rgb");
  message.utime = kNow;
  message.calibration.status = SolveStatus::kContradicted;
  message.calibration.detail = "Likeliest cause: the focal length.";
  return message;
}

TEST_F(FuserNodeTest, WhatIsNotToBeUsedIsNotTakenAndSaysWhy) {
  std::vector<std::string> warnings;
  node_.SetWarningHandler([&](const std::string& warning) { warnings.push_back(warning); });
  node_.Handle(Plain("rgb", kNow, 100));
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(node_.Handle(NotToBeUsed()).empty());
  EXPECT_EQ(FuseAt(kNow + kSecond).valid[0], 0U);
  EXPECT_FALSE(node_.HasCalibrations());
  const auto says = ::testing::AllOf(HasSubstr("camera rgb is not to be used"),
                                     HasSubstr("the focal length"), HasSubstr("--anyway"));
  EXPECT_THAT(warnings, ::testing::ElementsAre(says)) << "it comes again every second";
  EXPECT_THAT(node_.GetStatus().text, ::testing::AllOf(HasSubstr("no calibration yet"), says));
  // One that is good comes: all is well again.
  node_.Handle(Calibrated("rgb"));
  EXPECT_EQ(node_.GetStatus().text, "fusing");
  EXPECT_TRUE(node_.HasCalibrations());
  EXPECT_EQ(FuseAt(kNow + kSecond).valid[0], 1U);
  // It goes on where a later one is not to be used.
  node_.Handle(NotToBeUsed());
  EXPECT_EQ(FuseAt(kNow + kSecond).calibration_utime[0], kNow - 10 * kSecond);
  EXPECT_THAT(node_.GetStatus().text, ::testing::AllOf(HasSubstr("fusing; "), says));
  EXPECT_FALSE(node_.HasCalibrations());
}

TEST(FuserNodeAnyway, UsesWhatSpeaksAgainstItself) {
  FuserNode node(FuserNode::Ranges::kAsMeasured, Use::kAnyway);
  node.Handle(test::TextOf(TinyRig()));
  node.Handle(Plain("rgb", kNow, 100));
  CalibrationMessage message = NotToBeUsed();
  message.rig_hash = "0123456789abcdef";
  node.Handle(message);
  const auto out = Only<RgbdtCloud>(node.Handle(Chunk(kNow + kSecond)));
  EXPECT_EQ(out.at(0).valid[0], 1U);
  EXPECT_THAT(
      node.GetStatus().text,
      ::testing::AllOf(HasSubstr("fusing; used anyway: the calibration of camera rgb was "
                                 "made with another rig"),
                       HasSubstr("; used anyway: the calibration of camera rgb is not to")));
}

TEST_F(FuserNodeTest, AnotherRigForgetsTheCalibration) {
  node_.Handle(Calibrated("rgb"));
  node_.Handle(test::TextOf(TinyRig()));
  EXPECT_EQ(node_.GetStatus().text, "fusing");
  node_.Handle(Commented(TinyRig()));
  EXPECT_THAT(node_.GetStatus().text, HasSubstr("no calibration yet"));
}

TEST_F(FuserNodeTest, ShutterFramesAreCountedAndNotUsed) {
  node_.Handle(Calibrated("thermal"));
  node_.Handle(Plain("thermal", kNow, 3000));
  Image shutter = Plain("thermal", kNow + kSecond, 1);
  shutter.shutter_correcting = true;
  node_.Handle(shutter);
  EXPECT_EQ(FuseAt(kNow + kSecond + kSecond / 2).thermal_counts[0], 3000);
  EXPECT_EQ(Counter(node_.GetStatus(), "shutter frames"), 1);
}

TEST_F(FuserNodeTest, TheSweepsEndGoesOn) {
  CloudChunk end;
  end.cloud.sweep_utime = kNow;
  end.sweep_end = true;
  const auto out = Only<RgbdtCloud>(node_.Handle(end));
  ASSERT_EQ(out.size(), 1U);
  EXPECT_TRUE(out[0].sweep_end);
  EXPECT_EQ(out[0].sweep_utime, kNow);
  Encode(out[0]);  // and it can travel
}

TEST_F(FuserNodeTest, WrongImagesAreRefused) {
  Image image = Plain("rgb", kNow, 1);
  image.pixels = cv::Mat(4, 4, CV_8UC1, cv::Scalar(0));
  EXPECT_THAT(ErrorOf([&] { node_.Handle(image); }), HasSubstr("4x4"));
  image = Plain("rgb", kNow, 1);
  image.camera = "front";
  EXPECT_THAT(ErrorOf([&] { node_.Handle(image); }), HasSubstr("front"));
}

TEST_F(FuserNodeTest, ASweepGoesOutOnceMoreAtItsEnd) {
  node_.Handle(Calibrated("rgb"));
  node_.Handle(Plain("rgb", kNow, 100));
  FuseAt(kNow + kSecond);
  CloudChunk end = Chunk(kNow + kSecond + 100'000);
  end.cloud.first_line = 1;
  end.sweep_end = true;
  const Messages out = node_.Handle(end);
  ASSERT_EQ(out.size(), 2U);
  EXPECT_EQ(ChannelOf(out[0]), "RGBDT_CLOUD");
  EXPECT_EQ(ChannelOf(out[1]), "RGBDT_SWEEP");
  const auto whole = std::get<RgbdtCloud>(out[1]);
  EXPECT_EQ(whole.size(), 8U);
  EXPECT_TRUE(whole.sweep_end);
  EXPECT_EQ(whole.valid[0], 1U);
  Encode(whole);
}

TEST_F(FuserNodeTest, ACalibrationHoldsFromTheNextChunkOn) {
  node_.Handle(Calibrated("rgb"));
  node_.Handle(Plain("rgb", kNow, 100));
  FuseAt(kNow + kSecond);
  EXPECT_TRUE(node_.Handle(Calibrated("rgb")).empty()) << "it is republished every second";
  CalibrationMessage other = Calibrated("rgb");
  other.utime = kNow;
  other.calibration.camera_from_lidar.translation.x() += 0.5;
  const auto parts = Only<RgbdtCloud>(node_.Handle(other));
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_TRUE(parts[0].whole_sweep);
  EXPECT_EQ(parts[0].calibration_utime, (std::vector<Utime>{kNow - 10 * kSecond, 0}));
  EXPECT_EQ(FuseAt(kNow + kSecond).calibration_utime, (std::vector<Utime>{kNow, 0}));
}

StampedPose PoseAt(Utime utime, double x) {
  StampedPose pose;
  pose.utime = utime;
  pose.source = "gps_ins";
  pose.map_from_lidar.translation.x() = x;
  return pose;
}

TEST_F(FuserNodeTest, WithPosesTheMessageSaysWhereTheRigWas) {
  node_.Handle(Calibrated("rgb"));
  for (int i = -20; i <= 20; ++i) node_.Handle(PoseAt(kNow + kSecond + i * 50'000, 7 + 0.05 * i));
  node_.Handle(Plain("rgb", kNow + kSecond - 100'000, 100));
  const RgbdtCloud cloud = FuseAt(kNow + kSecond);
  ASSERT_TRUE(cloud.map_from_lidar);
  EXPECT_NEAR(cloud.map_from_lidar->translation.x(), 7, 1e-9);
  EXPECT_EQ(cloud.frame_utime, kNow + kSecond);
  // 1 m/s ahead: what is seen 20 ms later is 2 cm farther from where the rig was.
  EXPECT_NEAR(cloud.points[2].x(), 5.02, 1e-5);
  EXPECT_EQ(cloud.valid[0], 1U);
}

TEST_F(FuserNodeTest, APoseThatJumpsIsNamedAndCounted) {
  node_.Handle(PoseAt(kNow, 0));
  node_.Handle(PoseAt(kNow + 50'000, 0));
  node_.Handle(PoseAt(kNow, 0));
  EXPECT_EQ(Counter(node_.GetStatus(), "old poses"), 1);
  std::vector<std::string> warnings;
  node_.SetWarningHandler([&](const std::string& warning) { warnings.push_back(warning); });
  node_.Handle(PoseAt(kNow + 100'000, 100));
  EXPECT_THAT(warnings,
              ::testing::ElementsAre(::testing::AllOf(HasSubstr("gps_ins"), HasSubstr("jumps"))));
  EXPECT_EQ(Counter(node_.GetStatus(), "pose jumps"), 1);
}

TEST_F(FuserNodeTest, ACloudFromTheFutureTakesNothingAway) {
  node_.Handle(Calibrated("rgb"));
  node_.Handle(Plain("rgb", kNow, 100));
  node_.Handle(Plain("rgb", kNow + kSecond, 200));
  CloudChunk future = Chunk(kNow + 10'000 * kSecond);
  future.cloud.sweep_utime = kNow + 10'000 * kSecond;
  for (const auto& cloud : Only<RgbdtCloud>(node_.Handle(future))) {
    for (const std::uint32_t valid : cloud.valid) EXPECT_EQ(valid, 0U);
  }
  EXPECT_EQ(Counter(node_.GetStatus(), "without an image of their time"), 4);
  const RgbdtCloud cloud = FuseAt(kNow + kSecond / 2);
  EXPECT_EQ(cloud.valid[0], 1U);
  EXPECT_EQ(cloud.rgb[0][1], 100);
}

TEST_F(FuserNodeTest, AClockSetBackForgetsTheImagesFromBefore) {
  node_.Handle(Calibrated("rgb"));
  for (int i = 0; i < 40; ++i) node_.Handle(Plain("rgb", kNow + 1000 * kSecond + i, 50));
  for (int i = 0; i < 3; ++i) node_.Handle(Plain("rgb", kNow + i * kSecond, 100));
  const RgbdtCloud cloud = FuseAt(kNow + 2 * kSecond + kSecond / 2);
  EXPECT_EQ(cloud.valid[0], 1U);
  EXPECT_EQ(cloud.rgb[0][1], 100);
}

// Ranges 0.25 m too short, beams of ring 2 another 0.5 m, and beams that meet at 50 mm.
RangeErrors Off() {
  RangeErrors errors;
  errors.offset_m.value = 0.25;
  errors.rings = {{2, {0.5, 0}}};
  errors.beams_meet_m.value = 0.05;
  return errors;
}

CalibrationMessage Calibrated(const std::string& camera, const std::optional<RangeErrors>& errors) {
  CalibrationMessage message = Calibrated(camera);
  message.calibration.range_errors = errors;
  return message;
}

CloudChunk ChunkOfRings(Utime utime, bool sweep_end) {
  CloudChunk chunk = Chunk(utime);
  for (Eigen::Vector3f& point : chunk.cloud.points) point.z() = 1;
  chunk.cloud.ring = {0, 1, 2, 3};
  chunk.sweep_end = sweep_end;
  return chunk;
}

class CorrectedRanges : public ::testing::Test {
 protected:
  CorrectedRanges() {
    for (FuserNode* node : {&node_, &as_measured_}) {
      node->Handle(test::TextOf(TinyRig()));
      node->Handle(Plain("rgb", kNow, 100));
      node->SetWarningHandler([this](const std::string& warning) { warnings_.push_back(warning); });
    }
  }
  Messages Sweep() { return node_.Handle(ChunkOfRings(kNow + kSecond, true)); }

  FuserNode node_{FuserNode::Ranges::kCorrected}, as_measured_;
  std::vector<std::string> warnings_;
};

TEST_F(CorrectedRanges, ChunksAndSweepsAreFusedWherePointsTrulyAre) {
  for (FuserNode* node : {&node_, &as_measured_}) {
    node->Handle(Calibrated("rgb", Off()));
    node->Handle(Calibrated("thermal", Off()));
  }
  const CloudChunk measured = ChunkOfRings(kNow + kSecond, true);
  CloudChunk corrected = measured;
  corrected.cloud = Corrected(measured.cloud, Off());
  const Messages out = node_.Handle(measured);
  ASSERT_EQ(out.size(), 2U) << "the chunk, and the sweep";
  EXPECT_EQ(test::BytesOf(out), test::BytesOf(as_measured_.Handle(corrected)));
  for (const RgbdtCloud& cloud : Only<RgbdtCloud>(out)) {
    ASSERT_EQ(cloud.size(), 4U);
    // Of a range of sqrt(26) m; a beam that rises by 1 m in 5 starts 10 mm lower.
    EXPECT_NEAR(cloud.points[0].x(), 5 * (1 + 0.25 / std::sqrt(26.0)), 1e-5);
    EXPECT_NEAR(cloud.points[0].z(), 1 + 0.25 / std::sqrt(26.0) - 0.01, 1e-5);
    EXPECT_NEAR(cloud.points[2].x(), 5 * (1 + 0.75 / std::sqrt(26.0)), 1e-4);
    EXPECT_EQ(cloud.valid[0], 1U);
  }
  EXPECT_EQ(node_.GetStatus().text, "fusing, ranges corrected");
  EXPECT_TRUE(warnings_.empty());
}

TEST_F(CorrectedRanges, OnlyWhereAskedFor) {
  as_measured_.Handle(Calibrated("rgb", Off()));
  const auto out = Only<RgbdtCloud>(as_measured_.Handle(ChunkOfRings(kNow + kSecond, true)));
  ASSERT_EQ(out.size(), 2U);
  EXPECT_EQ(out[0].points, ChunkOfRings(kNow, true).cloud.points);
  EXPECT_EQ(as_measured_.GetStatus().text, "fusing");
  EXPECT_TRUE(warnings_.empty());
}

TEST_F(CorrectedRanges, WithoutRangeErrorsCloudsStayAsMeasuredWithOneWarning) {
  Sweep();
  EXPECT_TRUE(warnings_.empty()) << "there is no calibration yet";
  node_.Handle(Calibrated("rgb"));
  node_.Handle(Calibrated("thermal"));
  for (int i = 0; i < 3; ++i) {
    const auto out = Only<RgbdtCloud>(Sweep());
    ASSERT_EQ(out.size(), 2U);
    EXPECT_EQ(out[0].points, ChunkOfRings(kNow, true).cloud.points);
  }
  ASSERT_EQ(warnings_.size(), 1U);
  EXPECT_THAT(warnings_[0], HasSubstr("no range errors"));
  EXPECT_THAT(warnings_[0], HasSubstr("calibrate with this version"));
  EXPECT_EQ(node_.GetStatus().text, "fusing");
}

TEST_F(CorrectedRanges, OfCamerasThatDifferTheRigsFirstHoldsWithOneWarning) {
  RangeErrors other = Off();
  other.offset_m.value = 0.125;
  node_.Handle(Calibrated("thermal", other));
  node_.Handle(Calibrated("rgb", Off()));
  for (int i = 0; i < 3; ++i) {
    const auto out = Only<RgbdtCloud>(Sweep());
    EXPECT_EQ(out.at(0).points, Corrected(ChunkOfRings(kNow, true).cloud, Off()).points);
  }
  ASSERT_EQ(warnings_.size(), 1U);
  EXPECT_THAT(warnings_[0], HasSubstr("cameras differ"));
}

// A calibration's cameras come one after the other, and chunks come in between.
TEST_F(CorrectedRanges, BetweenACalibrationsMessagesNobodyWarns) {
  node_.Handle(Calibrated("rgb", RangeErrors{}));
  node_.Handle(Calibrated("thermal", RangeErrors{}));
  node_.Handle(Calibrated("rgb", Off()));
  node_.Handle(ChunkOfRings(kNow + kSecond, false));
  node_.Handle(Calibrated("thermal", Off()));
  Sweep();
  EXPECT_TRUE(warnings_.empty());
}

TEST_F(CorrectedRanges, OtherRangeErrorsHoldFromTheNextChunkOn) {
  node_.Handle(Calibrated("rgb", Off()));
  node_.Handle(ChunkOfRings(kNow + kSecond, false));
  EXPECT_TRUE(node_.Handle(Calibrated("rgb", Off())).empty()) << "it is republished every second";
  RangeErrors other = Off();
  other.offset_m.value = 0.125;
  // What the sweep has so far goes out by itself: no message mixes the two.
  const auto parts = Only<RgbdtCloud>(node_.Handle(Calibrated("rgb", other)));
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts[0].points, Corrected(ChunkOfRings(kNow, true).cloud, Off()).points);
  for (const RgbdtCloud& cloud : Only<RgbdtCloud>(Sweep())) {
    EXPECT_EQ(cloud.points, Corrected(ChunkOfRings(kNow, true).cloud, other).points);
  }
}

TEST_F(CorrectedRanges, AnotherRigForgetsThem) {
  node_.Handle(Calibrated("rgb", Off()));
  node_.Handle(Commented(TinyRig()));
  const auto out = Only<RgbdtCloud>(Sweep());
  EXPECT_EQ(out.at(0).points, ChunkOfRings(kNow, true).cloud.points);
  EXPECT_TRUE(warnings_.empty()) << "there is no calibration any more";
}

}  // namespace
}  // namespace rgbdt
