#include "services/runtime/node_runner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "calib/model/errors.h"
#include "calib/model/said_again.h"
#include "services/messages/codec.h"
#include "services/messages/limits.h"
#include "services/messages/status_counters.h"

namespace rgbdt {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

/// Answers each encoder reading as its ticks say; throws by negative ones.
class ScriptedNode : public Node {
 public:
  std::string name() const override { return "scripted"; }
  std::vector<std::string> Subscriptions() const override {
    return {"ENCODER", "CALIBRATION", "STATUS", "SESSION_EVENT", ".*_IMAGE"};
  }
  Messages Handle(const Message& message) override {
    handled.push_back(ChannelOf(message));
    const auto* reading = std::get_if<EncoderReading>(&message);
    if (reading == nullptr) return {};
    if (reading->ticks == -1) throw InputError("ticks are -1");
    if (reading->ticks == -2) throw std::runtime_error("out of range");
    if (reading->ticks == -3) throw 3;
    if (reading->ticks == -4) return {Pose(NAN), Pose(1)};
    if (reading->ticks == -5) return {Said(kSaidAgain), Said(41)};
    return Messages(static_cast<std::size_t>(reading->ticks), Pose(1));
  }
  Messages Advance(Utime now) override {
    if (advance_throws) throw std::runtime_error("cannot repeat");
    Warn("it is " + std::to_string(now));
    return {RigText{0, "hash", "text"}};
  }
  Messages UseSpareTime(Utime now) override {
    if (advance_throws) throw std::runtime_error("no time");
    spared.push_back(now);
    return {Pose(1)};
  }
  Status GetStatus() const override {
    Status status;
    status.ready = true;
    status.text = "waits";
    status.counters = counters;
    return status;
  }

  static StampedPose Pose(double x) {
    StampedPose pose;
    pose.utime = 1;
    pose.source = "scripted";
    pose.map_from_lidar.translation.x() = x;
    return pose;
  }

  static CalibrationMessage Said(std::int64_t seq) {
    CalibrationMessage message;
    message.seq = seq;
    message.calibration.camera = "rgb";
    return message;
  }

  std::vector<std::string> handled;
  std::vector<std::pair<std::string, std::int64_t>> counters;
  std::vector<Utime> spared;
  bool advance_throws = false;
};

class NodeRunnerTest : public ::testing::Test {
 protected:
  NodeRunnerTest() {
    runner_.SetProblemHandler([&](const std::string& problem) { problems_.push_back(problem); });
    bus_.Subscribe("POSE|RIG|STATUS|CALIBRATION",
                   [&](const std::string& channel, const std::uint8_t* data, std::size_t size) {
                     published_.push_back(Decode(channel, data, size));
                   });
  }

  void Send(const Message& message) {
    bus_.Publish(ChannelOf(message), Encode(message));
    bus_.Run();
  }
  void SendReading(std::int64_t seq, std::int64_t ticks = 0) {
    Send(EncoderReading{1000 + seq, seq, ticks, 0});
  }
  std::int64_t Counter(const std::string& name) const {
    return CounterOf(runner_.GetStatus(), name, -1);
  }

  MemoryBus bus_;
  ScriptedNode node_;
  NodeRunner runner_{&node_, &bus_};
  std::vector<std::string> problems_;
  Messages published_;
};

TEST_F(NodeRunnerTest, PublishesAnswersNumberedFromZero) {
  SendReading(0, 2);
  SendReading(1, 1);
  ASSERT_EQ(published_.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(SeqOf(published_[i]), static_cast<int>(i));
  EXPECT_EQ(runner_.received(), 2);
  EXPECT_EQ(runner_.dropped(), 0);
}

TEST_F(NodeRunnerTest, WhatIsSaidAgainTakesNoNumberAndIsNoGap) {
  SendReading(0, -5);
  SendReading(kSaidAgain, 0);
  SendReading(1, -5);
  std::vector<std::int64_t> numbers;
  for (const Message& message : published_) numbers.push_back(SeqOf(message));
  EXPECT_THAT(numbers, ElementsAre(kSaidAgain, 0, kSaidAgain, 1));
  EXPECT_EQ(runner_.dropped(), 0);
  EXPECT_EQ(runner_.gaps(), 0);
  for (const char* name : {"duplicates", "restarts", "late"}) EXPECT_EQ(Counter(name), -1) << name;
}

TEST_F(NodeRunnerTest, ExceptionsOfTheNodeAreCountedAndNamed) {
  SendReading(0, -1);
  EXPECT_EQ(runner_.GetStatus().last_problem, "ENCODER: ticks are -1");
  SendReading(1, -2);
  EXPECT_EQ(runner_.GetStatus().last_problem, "ENCODER: out of range");
  SendReading(2, -3);
  EXPECT_THAT(runner_.GetStatus().last_problem, HasSubstr("ENCODER: "));
  SendReading(3, 1);
  EXPECT_EQ(published_.size(), 1U);
  EXPECT_EQ(runner_.received(), 4);
  EXPECT_EQ(runner_.dropped(), 3);
  EXPECT_EQ(Counter("dropped ENCODER"), 3);
  EXPECT_EQ(runner_.gaps(), 0);
  EXPECT_EQ(problems_.size(), 3U);
}

TEST_F(NodeRunnerTest, RubbishIsCountedAndNamed) {
  bus_.Publish("ENCODER", Bytes{1, 2, 3});
  bus_.Publish("RGB_IMAGE", Encode(EncoderReading{1, 0, 0, 0}));
  bus_.Publish("\x1b[2J_IMAGE", Bytes{});
  bus_.Run();
  EXPECT_TRUE(node_.handled.empty());
  EXPECT_EQ(runner_.dropped(), 3);
  EXPECT_THAT(problems_, ElementsAre(HasSubstr("ENCODER: the message is no encoder_t"),
                                     HasSubstr("RGB_IMAGE: the message is no image_t"),
                                     Not(HasSubstr("\x1b"))));
  published_.clear();
  runner_.Advance(0);  // the status carries all this and is a valid message
  bus_.Run();
  ASSERT_EQ(published_.size(), 2U);
  EXPECT_EQ(std::get<Status>(published_[1]).last_problem, problems_.back());
}

TEST_F(NodeRunnerTest, WhatCannotBeSentIsDroppedAndTheRestGoesOut) {
  SendReading(0, -4);
  ASSERT_EQ(published_.size(), 1U);
  EXPECT_EQ(SeqOf(published_[0]), 0);  // the other never had a number
  EXPECT_EQ(runner_.dropped(), 1);
  EXPECT_THAT(runner_.GetStatus().last_problem,
              HasSubstr("publishing POSE: translation_m[0] is nan"));
}

TEST_F(NodeRunnerTest, CountsGapsByChannel) {
  for (const int seq : {7, 8, 12, 13}) SendReading(seq);
  EXPECT_EQ(runner_.gaps(), 3);
  EXPECT_EQ(Counter("gaps ENCODER"), 3);
  EXPECT_EQ(Counter("late"), -1);
}

TEST_F(NodeRunnerTest, LateDuplicateAndRestart) {
  for (const int seq : {0, 2, 1, 3, 3, 0, 1}) SendReading(seq);
  EXPECT_EQ(runner_.gaps(), 0);
  EXPECT_EQ(Counter("late"), 1);
  EXPECT_EQ(Counter("duplicates"), 1);
  EXPECT_EQ(Counter("restarts"), 1);
  EXPECT_EQ(Counter("gaps ENCODER"), -1);
  EXPECT_EQ(node_.handled.size(), 7U);
}

TEST_F(NodeRunnerTest, SeveralSendersOnOneChannel) {
  for (const std::int64_t seq : {0, 1, 2}) {
    Send(Status{"detector", seq, 1, true, "", "", {}});
    Send(Status{"solver", 100 + seq, 1, true, "", "", {}});
    Send(SessionEvent{1, 50 + seq, 1, "simulator", EventKind::kDone, "", 0, 0});
    Send(SessionEvent{1, seq, 1, "solver", EventKind::kDone, "", 0, 0});
  }
  EXPECT_EQ(runner_.gaps(), 0);
  Send(Status{"solver", 105, 1, true, "", "", {}});
  EXPECT_EQ(Counter("gaps STATUS"), 2);
}

// The solver numbers all cameras' calibrations in one row.
TEST_F(NodeRunnerTest, CalibrationsOfSeveralCamerasAreOneRow) {
  for (const std::int64_t seq : {0, 1, 2, 3}) {
    CalibrationMessage message;
    message.seq = seq;
    message.calibration.camera = seq % 2 == 0 ? "rgb" : "thermal";
    Send(message);
  }
  EXPECT_EQ(runner_.gaps(), 0);
}

TEST_F(NodeRunnerTest, AdvancePublishesWhatTheNodeSaysAndOnceASecondItsStatus) {
  SendReading(5, 0);
  for (const Utime now : {0, 999'999}) runner_.Advance(now);
  bus_.Run();
  EXPECT_EQ(published_.size(), 3U);
  runner_.Advance(1'000'000);
  bus_.Run();
  ASSERT_EQ(published_.size(), 5U);
  EXPECT_EQ(SeqOf(published_[2]), 1);
  EXPECT_EQ(SeqOf(published_[4]), 1);
  const auto& rig = std::get<RigText>(published_[0]);
  EXPECT_EQ(rig.text, "text");
  const auto& status = std::get<Status>(published_[1]);
  EXPECT_EQ(status.process, "scripted");
  EXPECT_EQ(status.utime, 1005);
  EXPECT_TRUE(status.ready);
  EXPECT_EQ(status.text, "waits");
  EXPECT_EQ(status.last_problem, "it is 0");
  EXPECT_EQ(runner_.dropped(), 0) << "a warning costs no message";
  EXPECT_EQ(status.counters[0], (std::pair<std::string, std::int64_t>("received", 1)));
}

TEST_F(NodeRunnerTest, MessagesComeBeforeWhatCanWait) {
  constexpr Utime kBusy = NodeRunner::kLongestBusy;
  for (const Utime now : {0, 1}) runner_.UseSpareTime(now, false);
  for (const Utime now : {Utime{2}, Utime{3}, kBusy}) runner_.UseSpareTime(now, true);
  EXPECT_THAT(node_.spared, ElementsAre(0, 1));
  runner_.UseSpareTime(kBusy + 1, true);  // under any load it has a turn
  runner_.UseSpareTime(kBusy + 2, true);
  EXPECT_THAT(node_.spared, ElementsAre(0, 1, kBusy + 1));
  bus_.Run();
  EXPECT_EQ(published_.size(), 3U);
}

TEST_F(NodeRunnerTest, ItsFirstTurnWaitsAsLong) {
  runner_.UseSpareTime(7, true);
  EXPECT_TRUE(node_.spared.empty());
  runner_.UseSpareTime(7 + NodeRunner::kLongestBusy, true);
  EXPECT_EQ(node_.spared.size(), 1U);
}

TEST_F(NodeRunnerTest, SpareTimeSurvivesTheNode) {
  node_.advance_throws = true;
  runner_.UseSpareTime(0, false);
  EXPECT_EQ(runner_.GetStatus().last_problem, "spare time: no time");
}

TEST_F(NodeRunnerTest, AdvanceSurvivesTheNode) {
  node_.advance_throws = true;
  runner_.Advance(0);
  bus_.Run();
  ASSERT_EQ(published_.size(), 1U);
  EXPECT_EQ(std::get<Status>(published_[0]).last_problem, "advancing: cannot repeat");
}

TEST_F(NodeRunnerTest, ACounterIsNoMoreThanAMessageMaySay) {
  node_.counters = {{"much", std::numeric_limits<std::int64_t>::max()}};
  runner_.Advance(0);
  bus_.Run();
  ASSERT_EQ(published_.size(), 2U) << "the status goes out";
  EXPECT_EQ(std::get<Status>(published_[1]).counters[0].second, kMaxInteger);
}

TEST_F(NodeRunnerTest, StrangersDoNotFillTheStatus) {
  for (int i = 0; i < 3000; ++i) bus_.Publish("C" + std::to_string(i) + "_IMAGE", Bytes{});
  bus_.Run();
  EXPECT_EQ(runner_.dropped(), 3000);
  EXPECT_LT(runner_.GetStatus().counters.size(), 200U);
}

}  // namespace
}  // namespace rgbdt
