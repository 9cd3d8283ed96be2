#include "services/replay/recording_node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <thread>
#include <variant>

#include "calib/files/atomic_file.h"
#include "calib/files/schema/rig_file.h"
#include "calib/model/errors.h"
#include "services/bus/log.h"
#include "services/messages/codec.h"
#include "services/messages/header.h"
#include "services/replay/telling_node.h"
#include "tests/numbers.h"
#include "tests/unit/files/test_data.h"
#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Property;
using ::testing::Throws;

RigText RigTextOf(const std::string& lidar) {
  const std::string text =
      "name: \"small\"\n"
      "lidar { name: \"lidar\" " +
      lidar +
      " }\n"
      "camera { name: \"rgb\" kind: COLOR width: 640 height: 480 pixel_format: MONO8\n"
      "  pinhole { fx: 500 fy: 500 cx: 320 cy: 240 } }\n"
      "target { squares_x: 8 squares_y: 6 square_m: 0.1 width_m: 1 height_m: 0.8 }\n";
  return {0, HashOfRigText(text), text};
}

// While it waits for anything at all, for the rig, and for calibrations.
TEST(WavePreview, EndsWithoutWaitingForWhatDoesNotCome) {
  const Bytes noise(1000, 7);
  WavePreview nothing({}, {});
  WavePreview noisy({}, {});
  noisy.Take("CLOUD", noise.data(), noise.size());
  WavePreview begun({}, {});
  begun.TakeRig(ParseRig(RigTextOf("").text, "RIG"));
  for (const WavePreview* one : {&nothing, &noisy, &begun}) EXPECT_TRUE(one->Clocks().empty());
}

TEST(WavePreview, OutlivesMessagesThatAreNone) {
  const RigText rig = RigTextOf("");
  Calibration calibration;
  calibration.rig_hash = rig.hash;
  WavePreview preview(calibration, {});
  preview.TakeRig(ParseRig(rig.text, "RIG"));
  const Bytes noise(1000, 7);
  for (int i = 0; i < 2000; ++i) {
    for (const char* channel : {"CLOUD", "RGB_IMAGE", "OTHER_IMAGE"}) {
      preview.Take(channel, noise.data(), noise.size());
    }
  }
  EXPECT_EQ(preview.WhyNot(), "");
  EXPECT_TRUE(preview.Clocks().empty());
}

class RecordingNodeTest : public ::testing::Test {
 protected:
  RecordingNode Make() {
    return {path_.string(), 2, [this](const std::string& line) { told_ = line; }};
  }
  static void Hear(const std::string& channel, RecordingNode* node) {
    Bytes bytes(kHeaderBytes, 0);
    bytes[14] = 1234 / 256;
    bytes[15] = 1234 % 256;
    node->Overhear(channel, bytes.data(), bytes.size(), kSecond);
  }

  test::TempDir dir_;
  const std::filesystem::path path_ = dir_ / "wave.lcmlog";
  std::string told_;
};

TEST_F(RecordingNodeTest, KeepsWhatTellsOfAWavedBoardFromTheFirstSweepOn) {
  RecordingNode node = Make();
  node.Advance(0);
  EXPECT_THAT(told_, HasSubstr("waiting"));
  node.Handle(RigTextOf(""));
  for (const char* channel : {"CLOUD", "RGB_IMAGE", "POSE", "RGBDT_CLOUD"}) Hear(channel, &node);
  const Messages messages = node.Advance(5 * kSecond);
  EXPECT_THAT(told_, HasSubstr("2 s left; 1 CLOUD, 1 RGB_IMAGE, 1 RIG"));
  ASSERT_EQ(messages.size(), 1U);
  const auto& progress = std::get<WaveProgress>(messages[0]);
  EXPECT_EQ(progress.phase, WavePhase::kRecording);
  EXPECT_EQ(progress.left_s, 2);
  EXPECT_EQ(progress.utime, 1234) << "of the newest image, as its bytes say";
  EXPECT_TRUE(Encode(progress).size() > 0);
  EXPECT_FALSE(node.finished());
  EXPECT_FALSE(std::filesystem::exists(path_)) << "it is not whole yet";
  node.Advance(7 * kSecond);
  ASSERT_TRUE(node.finished());
  Hear("CLOUD", &node);  // too late
  node.Close();
  std::vector<std::string> channels;
  LogReader log(path_.string());
  while (const auto event = log.Next()) channels.push_back(event->channel);
  EXPECT_THAT(channels, ElementsAre("RIG", "CLOUD", "RGB_IMAGE"));
}

TEST_F(RecordingNodeTest, ACalibrationOfAnotherRigIsToldAtOnce) {
  Calibration calibration;
  calibration.rig_hash = 1;
  WavePreview preview(calibration, {});
  RecordingNode node(
      path_.string(), 2, [](const std::string&) {}, &preview);
  node.Handle(RigTextOf(""));
  for (int i = 0; i < 1000 && preview.WhyNot().empty(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  const Messages messages = node.Advance(0);
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(std::get<WaveProgress>(messages[0]).phase, WavePhase::kFailed);
  EXPECT_TRUE(node.finished());
  EXPECT_THAT([&] { node.Close(); },
              Throws<InputError>(Property(&InputError::what, HasSubstr("RIG"))));
}

TEST_F(RecordingNodeTest, WhatIsMissingIsNamedAndAnEarlierRecordingStays) {
  WriteFileAtomically(path_, "before");
  const std::vector<std::string> heard{"", "CLOUD", "RIG", "RGB_IMAGE"};
  const std::vector<std::string> missing{"no sweep", "no RIG", "no image"};
  for (std::size_t i = 0; i < missing.size(); ++i) {
    RecordingNode node{path_.string(), 100, [](const std::string&) {}};
    node.Advance(0);
    for (std::size_t k = 1; k <= i; ++k) {
      if (heard[k] == "RIG") {
        node.Handle(RigTextOf(""));
      } else {
        Hear(heard[k], &node);
      }
    }
    node.Advance(RecordingNode::kPatience);
    EXPECT_FALSE(node.finished());
    node.Advance(RecordingNode::kPatience + 1);
    EXPECT_TRUE(node.finished());
    EXPECT_THAT(InputErrorOf([&] { node.Close(); }), HasSubstr(missing[i]));
    EXPECT_EQ(ReadWholeFile(path_), "before");
  }
}

TEST_F(RecordingNodeTest, ARigThatCannotDoItIsRefusedAtOnce) {
  RecordingNode node = Make();
  node.Handle(
      RigTextOf("turned_scanner { ticks_per_degree: 100 motor_from_scanner {"
                " quaternion_wxyz: [1, 0, 0, 0] translation_m: [0, 0, 0] } }"));
  EXPECT_TRUE(node.finished());
  EXPECT_THAT(InputErrorOf([&] { node.Close(); }), HasSubstr("turned scanner"));
  EXPECT_TRUE(std::filesystem::is_empty(path_.parent_path()));
}

TEST(TellingNode, TellsOnceASecondAndThreeTimesWhatCameOfIt) {
  WaveProgress recorded;
  recorded.phase = WavePhase::kRecording;
  recorded.utime = 7;
  recorded.left_s = 1;
  recorded.clocks = {{"rgb", Estimate{0.01, 0.001}, ""}};
  TellingNode node(recorded);
  int solving = 0;
  for (Utime now = 0; now < 3 * kSecond; now += kSecond / 10) {
    for (const Message& message : node.Advance(now)) {
      const auto& progress = std::get<WaveProgress>(message);
      EXPECT_EQ(progress.phase, WavePhase::kSolving);
      EXPECT_EQ(progress.utime, 7);
      EXPECT_EQ(progress.left_s, 0);
      EXPECT_EQ(progress.clocks.size(), 1U) << "what was known while it was recorded";
      ++solving;
    }
    node.Tell("solving ...");
  }
  EXPECT_EQ(solving, 3);
  EXPECT_EQ(node.GetStatus().text, "solving ...");
  EXPECT_FALSE(node.finished());
  node.End(WavePhase::kFailed, "no offset", {});
  int ended = 0;
  for (Utime now = 3 * kSecond; !node.finished() && now < 9 * kSecond; now += kSecond / 10) {
    for (const Message& message : node.Advance(now)) {
      EXPECT_EQ(std::get<WaveProgress>(message).phase, WavePhase::kFailed);
      EXPECT_EQ(std::get<WaveProgress>(message).text, "no offset");
      ++ended;
    }
  }
  EXPECT_EQ(ended, 3);
}

}  // namespace
}  // namespace rgbdt
