#include "services/export/export_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "calib/files/atomic_file.h"
#include "calib/files/schema/rig_file.h"
#include "calib/model/errors.h"
#include "calib/model/printable.h"
#include "services/bags/bag_reader.h"
#include "services/bus/log_writer.h"
#include "services/foxglove/foxglove.pb.h"
#include "services/messages/codec.h"
#include "tests/unit/files/test_data.h"
#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr Utime kStart = 1'700'000'000'000'000;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

const char kRig[] = R"(
name: "cart"
lidar { name: "vlp16" }
camera {
  name: "rgb" kind: COLOR width: 4 height: 2 pixel_format: BGR8
  pinhole { fx: 5 fy: 5 cx: 1.5 cy: 0.5 }
  camera_from_lidar_guess { quaternion_wxyz: [1, 0, 0, 0] translation_m: [1, 0, 0] }
}
target { squares_x: 11 squares_y: 8 square_m: 0.1 width_m: 1.2192 height_m: 0.9144 }
)";

CloudChunk Chunk(Utime sweep, int line, int lines) {
  CloudChunk chunk;
  chunk.cloud.sweep_utime = sweep;
  chunk.cloud.first_line = line;
  chunk.cloud.lines = 1;
  chunk.cloud.beams = 2;
  chunk.cloud.points = {{1, static_cast<float>(line), 0}, {kNan, kNan, kNan}};
  chunk.cloud.utime = {sweep + 1000 * line, sweep + 1000 * line + 1};
  chunk.sweep_end = line + 1 == lines;
  chunk.sweep_lines = chunk.sweep_end ? lines : 0;
  return chunk;
}

RgbdtCloud Fused(Utime sweep, bool end, bool whole) {
  RgbdtCloud cloud;
  cloud.sweep_utime = sweep;
  cloud.sweep_end = end;
  cloud.whole_sweep = whole;
  cloud.cameras = {"rgb"};
  cloud.calibration_utime = {kStart};
  cloud.points = {{1, 0, 0}};
  cloud.intensity = {0.5F};
  cloud.utime = {sweep};
  cloud.rgb = {{1, 2, 3}};
  cloud.temperature_k = cloud.temperature_sigma_k = cloud.thermal_counts = {kNan};
  cloud.valid = {1};
  return cloud;
}

CalibrationMessage Calibrated(SolveStatus status) {
  CalibrationMessage message;
  message.utime = kStart - 50;
  message.rig_hash = HashOfRigText(kRig);
  message.method = "auto";
  message.calibration.camera = "rgb";
  message.calibration.camera_from_lidar.translation = {0, 2, 0};
  message.calibration.status = status;
  message.calibration.covariance = Matrix6d(1e-6 * Matrix6d::Identity());
  return message;
}

class ExportingLog : public testing::Test {
 protected:
  ExportingLog() : log_(dir_ / "log") {}

  template <typename M>
  void Add(const M& message) {
    log_.Write(ChannelOf(message), Encode(message), 42);  // what lcm-logger's clock said
  }
  ExportedLog Export(const FoxgloveFrames& frames = {}) {
    log_.Close();
    return ExportLog(dir_ / "log", dir_ / "out.mcap", frames);
  }
  // Decoded, in the file's order.
  template <typename M>
  std::vector<M> Read(const std::string& topic) {
    std::vector<M> messages;
    const auto bag = OpenBag(dir_ / "out.mcap");
    BagMessage message;
    while (bag->Next(&message)) {
      EXPECT_GE(message.log_utime, last_);
      last_ = message.log_utime;
      if (bag->topics()[message.topic].name != topic) continue;
      EXPECT_EQ(bag->topics()[message.topic].type, M::descriptor()->full_name());
      messages.emplace_back();
      EXPECT_TRUE(messages.back().ParseFromArray(message.data, static_cast<int>(message.size)));
    }
    EXPECT_THAT(bag->problems(), IsEmpty());
    last_ = 1;
    return messages;
  }

  test::TempDir dir_;
  LogWriter log_;
  Utime last_ = kStart - 1000;  // nothing is logged before the first sensor time
};

TEST_F(ExportingLog, SweepsComeAsTheyEndAndThoseThatAreTornAreCounted) {
  Status early;  // before any sensor's time
  early.process = "assembler";
  Add(early);
  for (const int line : {0, 1, 2}) Add(Chunk(kStart, line, 3));
  for (const int line : {0, 2}) Add(Chunk(kStart + 100'000, line, 3));  // one is lost
  Add(Chunk(kStart + 200'000, 0, 3));                                   // never ends
  const ExportedLog exported = Export();
  EXPECT_EQ(exported.topics.at("/lidar/points").messages, 2);
  EXPECT_EQ(exported.torn_sweeps, 2);
  EXPECT_EQ(exported.dropped, 0) << "messages";
  const auto clouds = Read<foxglove::PointCloud>("/lidar/points");
  ASSERT_THAT(clouds, SizeIs(2));
  for (const auto& cloud : clouds) {
    EXPECT_EQ(cloud.data().size(), 6 * cloud.point_stride());
    EXPECT_EQ(cloud.frame_id(), "lidar");
  }
  EXPECT_EQ(clouds[1].timestamp().nanos(), 100'000'000);
}

TEST_F(ExportingLog, OfFusedCloudsTheWholeSweepsOnce) {
  Add(Fused(kStart, false, false));
  Add(Fused(kStart, true, false));
  Add(Fused(kStart, false, true));
  Add(Fused(kStart, true, true));
  Export();
  const auto clouds = Read<foxglove::PointCloud>("/fused/points");
  ASSERT_THAT(clouds, SizeIs(1));
  EXPECT_EQ(clouds[0].data().size(), 2 * clouds[0].point_stride());
}

// Chunks that were fused on the way are put into the frame of the first.
TEST_F(ExportingLog, FusedChunksOfARigThatMovesAreOneCloud) {
  RgbdtCloud first = Fused(kStart, false, false), second = Fused(kStart, true, false);
  first.map_from_lidar = Rigid3{Eigen::Quaterniond::Identity(), {10, 0, 0}};
  first.frame_utime = kStart;
  second.map_from_lidar = Rigid3{Eigen::Quaterniond::Identity(), {12, 0, 0}};
  second.frame_utime = kStart + 5;
  Add(first);
  Add(second);
  Export();
  const auto clouds = Read<foxglove::PointCloud>("/fused/points");
  ASSERT_THAT(clouds, SizeIs(1));
  EXPECT_EQ(clouds[0].pose().position().x(), 10);
  float x = 0;
  std::memcpy(&x, clouds[0].data().data() + clouds[0].point_stride(), sizeof(x));
  EXPECT_EQ(x, 3);
}

TEST_F(ExportingLog, ACalibrationTakesAGuesssPlaceAndTheLensGoesWithIt) {
  const RigText rig{0, HashOfRigText(kRig), kRig};
  Add(Chunk(kStart, 0, 1));
  Add(rig);
  Add(Calibrated(SolveStatus::kDegenerate));  // not to be used: told, no transform
  Add(Calibrated(SolveStatus::kConverged));
  Add(rig);
  const ExportedLog exported = Export({"", {{"rgb", "front"}}});
  EXPECT_EQ(exported.dropped, 0) << exported.last_problem;
  const auto transforms = Read<foxglove::FrameTransforms>("/tf_static");
  ASSERT_THAT(transforms, SizeIs(2));
  EXPECT_EQ(transforms[0].transforms(0).parent_frame_id(), "vlp16");
  EXPECT_EQ(transforms[0].transforms(0).child_frame_id(), "front");
  EXPECT_EQ(transforms[0].transforms(0).translation().x(), -1) << "the camera in the LIDAR frame";
  EXPECT_EQ(transforms[1].transforms(0).translation().y(), -2);
  EXPECT_THAT(Read<foxglove::CameraCalibration>("/rgb/camera_info"), SizeIs(2));
  const auto events = Read<foxglove::Log>("/events");
  ASSERT_THAT(events, SizeIs(1));
  EXPECT_EQ(events[0].level(), foxglove::Log::WARNING);
  EXPECT_THAT(events[0].message(), HasSubstr("degenerate"));
}

TEST_F(ExportingLog, ACalibrationThatComesBeforeItsRigIsKept) {
  Add(Chunk(kStart, 0, 1));
  Add(Calibrated(SolveStatus::kConverged));
  Add(RigText{0, HashOfRigText(kRig), kRig});
  const ExportedLog exported = Export();
  EXPECT_EQ(exported.dropped, 0) << exported.last_problem;
  const auto transforms = Read<foxglove::FrameTransforms>("/tf_static");
  ASSERT_THAT(transforms, SizeIs(1)) << "and no guess after it";
  EXPECT_EQ(transforms[0].transforms(0).translation().y(), -2);
}

TEST_F(ExportingLog, AnotherRigsCalibrationGivesWayToTheGuess) {
  Add(Chunk(kStart, 0, 1));
  CalibrationMessage other = Calibrated(SolveStatus::kConverged);
  other.rig_hash = HashOfRigText("another");
  Add(other);
  Add(RigText{0, HashOfRigText(kRig), kRig});
  Export();
  const auto transforms = Read<foxglove::FrameTransforms>("/tf_static");
  ASSERT_THAT(transforms, SizeIs(2));
  EXPECT_EQ(transforms[1].transforms(0).translation().x(), -1);
}

TEST_F(ExportingLog, AJpegGoesOnAsItWasSent) {
  Image image;
  image.camera = "rgb";
  image.utime = kStart;
  image.format = PixelFormat::kJpeg;
  image.pixels = cv::Mat(16, 16, CV_8UC3, cv::Scalar(10, 20, 30));
  Add(image);
  image.format = PixelFormat::kBgr8;
  Add(image);
  Export();
  const auto files = Read<foxglove::CompressedImage>("/rgb/image_raw/compressed");
  ASSERT_THAT(files, SizeIs(1));
  EXPECT_EQ(files[0].format(), "jpeg");
  image.format = PixelFormat::kJpeg;
  const Bytes sent = Encode(image), file = ImageFileOf(sent.data(), sent.size());
  EXPECT_EQ(files[0].data(), std::string(file.begin(), file.end()));
  EXPECT_THAT(Read<foxglove::RawImage>("/rgb/image_raw"), SizeIs(1));
}

TEST_F(ExportingLog, APoseIsATransformToo) {
  Add(StampedPose{0, kStart, "odometry", {Eigen::Quaterniond::Identity(), {1, 2, 3}}});
  Export({"velodyne", {}});
  EXPECT_EQ(Read<foxglove::PoseInFrame>("/pose").at(0).pose().position().z(), 3);
  const auto transform = Read<foxglove::FrameTransforms>("/tf").at(0).transforms(0);
  EXPECT_EQ(transform.parent_frame_id(), "map");
  EXPECT_EQ(transform.child_frame_id(), "velodyne");
}

TEST_F(ExportingLog, AProblemIsAWarningOnce) {
  Status status;
  status.process = "fuser";
  status.utime = kStart;
  status.text = "fuses";
  Add(status);
  status.last_problem = "a gap";
  Add(status);
  Add(status);
  Export();
  std::vector<std::string> lines;
  for (const auto& line : Read<foxglove::Log>("/status")) {
    lines.push_back(std::to_string(line.level()) + " " + line.name() + ": " + line.message());
  }
  EXPECT_THAT(lines, ElementsAre("2 fuser: fuses", "3 fuser: fuses; a gap", "2 fuser: fuses"));
}

TEST_F(ExportingLog, WhatCannotBeReadCostsItselfAlone) {
  Add(Chunk(kStart, 0, 1));
  log_.Write("CLOUD", Bytes(100, 7), 42);
  log_.Write("NOBODYS", Bytes(100, 7), 42);
  const ExportedLog exported = Export();
  EXPECT_EQ(exported.dropped, 1);
  EXPECT_THAT(exported.last_problem, HasSubstr("CLOUD: "));
  EXPECT_EQ(exported.left_out.at("NOBODYS"), 1);
  EXPECT_EQ(exported.topics.at("/lidar/points").messages, 1);
}

TEST_F(ExportingLog, ALogOfChannelsWithoutEndNamesSomeOfThem) {
  Add(Chunk(kStart, 0, 1));
  constexpr int kChannels = 5'000;
  for (int i = 0; i < kChannels; ++i) log_.Write("NOBODYS_" + std::to_string(i), Bytes(1, 7), 42);
  const ExportedLog exported = Export();
  EXPECT_LE(exported.left_out.size(), 101U);
  std::int64_t messages = 0;
  for (const auto& [channel, count] : exported.left_out) messages += count;
  EXPECT_EQ(messages, kChannels);
  EXPECT_GT(exported.left_out.at("other channels"), 4'000);
}

TEST_F(ExportingLog, AChannelThatMovesACursorIsToldWithout) {
  Add(Chunk(kStart, 0, 1));
  log_.Write("\x1b[2J\n_IMAGE", Bytes(100, 7), 42);
  const ExportedLog exported = Export();
  EXPECT_EQ(exported.dropped, 1);
  EXPECT_TRUE(IsPrintable(exported.last_problem)) << exported.last_problem;
}

TEST_F(ExportingLog, WithoutAnythingToExportTheOldFileStays) {
  WriteFileAtomically(dir_ / "out.mcap", "old");
  log_.Write("NOBODYS", Bytes(100, 7), 42);
  EXPECT_THAT(test::ErrorOf([&] { Export(); }), HasSubstr("nothing to export"));
  EXPECT_EQ(ReadWholeFile(dir_ / "out.mcap"), "old");
}

TEST_F(ExportingLog, FramesHaveNamesOfTheirOwn) {
  Add(Chunk(kStart, 0, 1));
  log_.Close();
  for (const FoxgloveFrames& frames :
       {FoxgloveFrames{"a b", {}}, FoxgloveFrames{"x", {{"rgb", "x"}}},
        FoxgloveFrames{"", {{"rgb", ""}}}}) {
    EXPECT_THROW(ExportLog(dir_ / "log", dir_ / "out.mcap", frames), InputError);
  }
}

}  // namespace
}  // namespace rgbdt
