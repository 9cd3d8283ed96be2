#include "services/simulator/simulator_node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/nodes/assembler_node.h"
#include "tests/nodes/nodes_testing.h"

namespace rgbdt {
namespace {

using test::Only;

SessionCommand Command(std::int64_t number, SessionVerb verb) {
  SessionCommand command;
  command.command = number;
  command.verb = verb;
  command.view = "0001";
  if (verb == SessionVerb::kCapture) command.picked_cameras = {"thermal"};
  return command;
}

class SimulatorNodeTest : public ::testing::Test {
 protected:
  // Until time stands still; when each message left goes to due_.
  Messages RunOut(SimulatorNode* node) {
    Messages out;
    for (; !node->time_stands_still(); now_ += 100) {
      for (Message& message : node->Advance(now_)) {
        due_.push_back(node->simulated_now());
        out.push_back(std::move(message));
      }
    }
    return out;
  }
  Messages View(SimulatorNode* node) {
    Messages out;
    std::int64_t number = 0;
    for (const SessionVerb verb :
         {SessionVerb::kNextPose, SessionVerb::kSweep, SessionVerb::kCapture}) {
      node->Handle(Command(++number, verb));
      for (Message& message : RunOut(node)) out.push_back(std::move(message));
    }
    return out;
  }

  SimulatorNode node_{test::TinyOptions()};
  std::vector<Utime> due_;
  Utime now_ = 77;
};

TEST_F(SimulatorNodeTest, TimeStandsStillUntilACommandComes) {
  EXPECT_TRUE(node_.time_stands_still());
  EXPECT_TRUE(node_.GetStatus().ready);
  EXPECT_TRUE(node_.Advance(0).empty());
  node_.Handle(Command(1, SessionVerb::kNextPose));
  EXPECT_FALSE(node_.time_stands_still());
  const auto events = Only<SessionEvent>(node_.Advance(1000 * kMicrosecondsPerSecond));
  ASSERT_EQ(events.size(), 1U) << "what was due while time stood still is not made up for";
  EXPECT_EQ(events[0].utime, SimulatorNode::kEpoch);
  now_ = 1000 * kMicrosecondsPerSecond;
  RunOut(&node_);
  EXPECT_EQ(now_ / kMicrosecondsPerSecond, 1002) << "the board is carried for two seconds";
  node_.Handle(Command(2, SessionVerb::kSolve));
  EXPECT_TRUE(node_.time_stands_still());
}

TEST_F(SimulatorNodeTest, ASpeedShortensTheWait) {
  SimulatorNode fast(test::TinyOptions(), 10);
  fast.Handle(Command(1, SessionVerb::kNextPose));
  RunOut(&fast);
  EXPECT_NEAR(ToSeconds(now_), 0.21, 0.01);
}

TEST_F(SimulatorNodeTest, TheTruthIsToldWhenTheBoardHasMoved) {
  std::vector<std::size_t> views;
  SimulatorNode node(test::TinyOptions(), 1,
                     [&](const Truth& truth) { views.push_back(truth.lidar_from_target.size()); });
  View(&node);
  EXPECT_THAT(views, ::testing::ElementsAre(1));
}

TEST_F(SimulatorNodeTest, WhatCannotBeSimulatedIsAWarning) {
  std::vector<std::string> warnings;
  node_.SetWarningHandler([&](const std::string& warning) { warnings.push_back(warning); });
  node_.Handle(Command(1, SessionVerb::kCapture));  // before any board: there is nothing to pick
  const auto events = Only<SessionEvent>(RunOut(&node_));
  EXPECT_THAT(warnings, ::testing::ElementsAre(::testing::HasSubstr("no board to pick corners")));
  EXPECT_EQ(events.size(), 1U);
}

TEST_F(SimulatorNodeTest, MessagesComeWhenTheRealSensorWouldHaveSentThem) {
  const Messages all = View(&node_);
  EXPECT_TRUE(std::is_sorted(due_.begin(), due_.end()));
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (const auto* line = std::get_if<LineScan>(&all[i])) {
      const Utime last = line->utime + FromSeconds(39 * line->beam_period_s);
      EXPECT_GT(due_[i], last);
    } else if (const auto* image = std::get_if<Image>(&all[i])) {
      const double readout_s = node_.simulator().rig().Camera(image->camera).readout_s;
      EXPECT_GE(due_[i], image->utime + FromSeconds(readout_s));
    } else {
      EXPECT_GE(due_[i], UtimeOf(all[i])) << ChannelOf(all[i]);
    }
  }
  EXPECT_EQ(Only<LineScan>(all).size(), 25U);
  EXPECT_EQ(Only<CornerSelection>(all).size(), 1U);
  Utime newest = 0;
  for (const EncoderReading& reading : Only<EncoderReading>(all)) {
    EXPECT_GT(reading.utime, newest);
    newest = reading.utime;
  }
}

TEST_F(SimulatorNodeTest, EveryCommandIsAnsweredAfterItsData) {
  const Messages all = View(&node_);
  std::vector<std::int64_t> done;
  Utime sweep = 0;
  for (const SessionEvent& event : Only<SessionEvent>(all)) {
    EXPECT_EQ(event.source, "simulator");
    if (event.kind != EventKind::kDone) continue;
    done.push_back(event.command);
    if (event.sweep_utime != 0) sweep = event.sweep_utime;
  }
  EXPECT_THAT(done, ::testing::ElementsAre(1, 2, 3));
  EXPECT_TRUE(std::holds_alternative<SessionEvent>(all.back()));
  const auto lines = Only<LineScan>(all);
  EXPECT_EQ(sweep, lines.front().utime);
  const auto images = Only<Image>(all);
  ASSERT_GE(images.size(), 4U);
  EXPECT_EQ(images.back().camera, "thermal");
  EXPECT_EQ(Only<CornerSelection>(all)[0].image_utime, images.back().utime);
}

TEST_F(SimulatorNodeTest, TheCaptureIsNotBeforeTheCommandsTime) {
  View(&node_);
  SessionCommand capture = Command(9, SessionVerb::kCapture);
  capture.utime = SimulatorNode::kEpoch + 1000 * kMicrosecondsPerSecond;
  node_.Handle(capture);
  for (const Image& image : Only<Image>(RunOut(&node_))) EXPECT_EQ(image.utime, capture.utime);
}

TEST_F(SimulatorNodeTest, ARestartRepeatsItselfBitForBit) {
  const auto expected = test::BytesOf(View(&node_));
  SimulatorNode again(test::TinyOptions());
  EXPECT_EQ(test::BytesOf(View(&again)), expected);
  simulate::Options options = test::TinyOptions();
  options.seed = 2;
  SimulatorNode other(options);
  EXPECT_NE(test::BytesOf(View(&other)), expected);
}

// Killed after its second view, which is swept once more.
TEST_F(SimulatorNodeTest, StartedAnewInASessionTheBoardStandsWhereItStoodAndTimeGoesOn) {
  Truth truth;
  const auto keep = [&](const Truth& t) { truth = t; };
  simulate::Simulator reference(test::TinyOptions());
  reference.ShowView(1, "0002");
  for (const auto& verbs : {std::vector{SessionVerb::kNextPose, SessionVerb::kSweep},
                            std::vector{SessionVerb::kSweep}}) {
    SimulatorNode node(test::TinyOptions(), 1, keep);
    std::int64_t number = 20;
    Messages out;
    for (const SessionVerb verb : verbs) {
      SessionCommand command = Command(++number, verb);
      command.view = "0002";
      command.utime = SimulatorNode::kEpoch + 100 * kMicrosecondsPerSecond;
      node.Handle(command);
      for (Message& message : RunOut(&node)) out.push_back(std::move(message));
    }
    ASSERT_EQ(truth.lidar_from_target.count("0002"), 1U);
    EXPECT_EQ(truth.lidar_from_target["0002"].translation,
              reference.truth().lidar_from_target.at("0002").translation);
    ASSERT_EQ(Only<LineScan>(out).size(), 25U);
    for (const LineScan& line : Only<LineScan>(out)) {
      EXPECT_GT(line.utime, SimulatorNode::kEpoch + 100 * kMicrosecondsPerSecond);
    }
  }
}

TEST_F(SimulatorNodeTest, TheAssemblerMakesAWholeSweepOfIt) {
  AssemblerNode assembler;
  assembler.Handle(test::TextOf(test::RigOf(node_.simulator())));
  std::vector<CloudChunk> chunks;
  std::map<std::size_t, std::int64_t> seq;  // as NodeRunner numbers them
  for (Message& message : View(&node_)) {
    if (ChannelOf(message) != "LINE_SCAN" && ChannelOf(message) != "ENCODER") continue;
    SetSeq(seq[message.index()]++, &message);
    for (CloudChunk& chunk : Only<CloudChunk>(assembler.Handle(message))) {
      chunks.push_back(std::move(chunk));
    }
  }
  ASSERT_EQ(chunks.size(), 26U);
  EXPECT_TRUE(chunks.back().sweep_end);
  EXPECT_EQ(chunks.back().sweep_lines, 25);
  EXPECT_EQ(chunks.back().lines_lost, 0);
}

}  // namespace
}  // namespace rgbdt
