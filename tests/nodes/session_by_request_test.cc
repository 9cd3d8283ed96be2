#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calib/files/atomic_file.h"
#include "calib/files/schema/calibration_file.h"
#include "calib/files/session/session_dir.h"
#include "services/nodes/session_node.h"
#include "tests/nodes/session_world.h"
#include "tests/unit/files/test_data.h"

// A session that a person leads, and what a person may do in one that a script leads.

namespace rgbdt {
namespace {

using test::Counter;
using test::ErrorOf;
using test::Only;
using test::TinyRig;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class SessionByRequestTest : public ::testing::Test {
 protected:
  SessionByRequestTest() : node_(TinyRig(), dir_ / "session", {}) {}

  void EverybodyReady() {
    for (const char* process : {"assembler", "detector", "solver", "fuser"}) {
      node_.Handle(test::Ready(process));
    }
    Run();
  }
  // Until there is nothing to do; a second a turn, a minute at most.
  void Run() {
    for (int turn = 0; turn < 60; ++turn) {
      const Messages said = test::AdvanceTo(time_s_ += 1, &node_);
      for (const SessionEvent& event : Only<SessionEvent>(said)) events_.push_back(event);
      for (const SessionCommand& command : Only<SessionCommand>(said)) {
        test::HandleAll(&node_, world_.Answer(command));
      }
    }
  }
  void Ask(SessionRequestKind kind, bool heldout = false) {
    SessionRequest request;
    request.request = kind;
    request.heldout = heldout;
    node_.Handle(request);
  }
  std::vector<SessionVerb> Verbs() const {
    std::vector<SessionVerb> verbs;
    for (const SessionCommand& command : world_.commands) verbs.push_back(command.verb);
    return verbs;
  }

  test::TempDir dir_;
  test::World world_;
  SessionNode node_;
  double time_s_ = 0;
  std::vector<SessionEvent> events_;
};

TEST_F(SessionByRequestTest, ACaptureSweepsTakesTheViewAndSolves) {
  EverybodyReady();
  EXPECT_THAT(Verbs(), ElementsAre(SessionVerb::kReset));
  EXPECT_EQ(Counter(node_.GetStatus(), "by request"), 1);
  EXPECT_EQ(Counter(node_.GetStatus(), "busy"), 0);
  Ask(SessionRequestKind::kCapture, true);
  EXPECT_EQ(Counter(node_.GetStatus(), "busy"), 1);
  Run();
  EXPECT_THAT(Verbs(), ElementsAre(SessionVerb::kReset, SessionVerb::kSweep, SessionVerb::kCapture,
                                   SessionVerb::kSolve, SessionVerb::kEvaluate));
  EXPECT_EQ(Counter(node_.GetStatus(), "busy"), 0);
  EXPECT_TRUE(ReadView(OpenSession(dir_ / "session"), "0001").heldout);
  EXPECT_EQ(events_.back().kind, EventKind::kDone);
  EXPECT_EQ(events_.back().source, "session");
}

TEST_F(SessionByRequestTest, EachCaptureIsAViewOfItsOwnWithOrWithoutANextPose) {
  EverybodyReady();
  for (const auto kind : {SessionRequestKind::kCapture, SessionRequestKind::kNextPose,
                          SessionRequestKind::kCapture, SessionRequestKind::kCapture}) {
    Ask(kind);
    Run();
  }
  EXPECT_THAT(OpenSession(dir_ / "session").views, ElementsAre("0001", "0002", "0003"));
}

TEST_F(SessionByRequestTest, FinishSavesAndEnds) {
  EverybodyReady();
  Ask(SessionRequestKind::kCapture);
  Run();
  Ask(SessionRequestKind::kFinish);
  Run();
  EXPECT_TRUE(node_.finished());
  EXPECT_EQ(node_.failure(), "");
  EXPECT_EQ(ReadCalibration(dir_ / "session/calibration.textproto").rig_hash, TinyRig().hash);
  EXPECT_THAT(events_.back().text, HasSubstr("saved to"));
  EXPECT_THAT(ErrorOf([&] { SessionNode(TinyRig(), dir_ / "session", {}); }),
              HasSubstr("has ended"));
}

TEST_F(SessionByRequestTest, WhatASessionWithoutViewsLeftIsNotTakenForThisOnes) {
  for (const char* file : {"left_out_views.lcm", "ended"}) {
    WriteFileAtomically(dir_ / "session" / file, "of views that were removed");
  }
  EverybodyReady();
  for (const char* file : {"left_out_views.lcm", "ended"}) {
    EXPECT_FALSE(std::filesystem::exists(dir_ / "session" / file)) << file;
  }
}

TEST_F(SessionByRequestTest, AFinishWithoutAPoseLeavesASessionThatIsGoneOnWith) {
  world_.solved = false;
  EverybodyReady();
  Ask(SessionRequestKind::kCapture);
  Run();
  Ask(SessionRequestKind::kFinish);
  Run();
  EXPECT_FALSE(node_.finished());
  EXPECT_TRUE(std::filesystem::exists(dir_ / "session/report.json"));
  EXPECT_NO_THROW(SessionNode(TinyRig(), dir_ / "session", {}));
}

// As on a full disk. The views stay, and once there is room finish is asked for again.
TEST_F(SessionByRequestTest, AFinishThatCannotBeWrittenIsSaidAndMayBeRepeated) {
  EverybodyReady();
  Ask(SessionRequestKind::kCapture);
  Run();
  for (const char* file : {"calibration.textproto", "report.json"}) {
    std::filesystem::create_directories(dir_ / "session" / file / "in the way");
    Ask(SessionRequestKind::kFinish);
    Run();
    EXPECT_FALSE(node_.finished());
    EXPECT_EQ(events_.back().kind, EventKind::kFailed);
    EXPECT_THAT(events_.back().text, AllOf(HasSubstr("save"), HasSubstr(file)));
    EXPECT_EQ(Counter(node_.GetStatus(), "busy"), 0);
    EXPECT_THAT(OpenSession(dir_ / "session").views, ElementsAre("0001"));
    std::filesystem::remove_all(dir_ / "session" / file);
  }
  Ask(SessionRequestKind::kFinish);
  Run();
  EXPECT_TRUE(node_.finished());
  EXPECT_EQ(node_.failure(), "");
  EXPECT_EQ(ReadCalibration(dir_ / "session/calibration.textproto").rig_hash, TinyRig().hash);
}

TEST_F(SessionByRequestTest, AFailureIsSaidAndThePersonGoesOn) {
  EverybodyReady();
  world_.failing_at = SessionVerb::kSweep;
  Ask(SessionRequestKind::kCapture);
  Run();
  EXPECT_FALSE(node_.finished());
  EXPECT_EQ(events_.back().kind, EventKind::kFailed);
  EXPECT_THAT(events_.back().text, HasSubstr("the motor is stuck"));
  EXPECT_EQ(world_.commands.back().verb, SessionVerb::kSweep) << "nothing more is asked for";
  world_.failing_at.reset();
  Ask(SessionRequestKind::kCapture);
  Run();
  EXPECT_EQ(world_.commands.back().verb, SessionVerb::kEvaluate);
  EXPECT_EQ(node_.failure(), "");
}

TEST_F(SessionByRequestTest, CamerasThatCannotBeSolvedAreSaidAtTheFinishAndMoreViewsMayFollow) {
  EverybodyReady();
  world_.solved = false;
  Ask(SessionRequestKind::kCapture);
  Run();
  Ask(SessionRequestKind::kFinish);
  Run();
  EXPECT_FALSE(node_.finished());
  EXPECT_THAT(events_.back().text, HasSubstr("2 usable views"));
  world_.solved = true;
  Ask(SessionRequestKind::kCapture);
  Run();
  Ask(SessionRequestKind::kFinish);
  Run();
  EXPECT_TRUE(node_.finished());
}

TEST_F(SessionByRequestTest, AskedTooEarlyOrTwiceIsRefusedWithTheReason) {
  EXPECT_THAT(ErrorOf([&] { Ask(SessionRequestKind::kCapture); }),
              HasSubstr("rgbdt-detector (not heard)"));
  EverybodyReady();
  Ask(SessionRequestKind::kCapture);
  EXPECT_THAT(ErrorOf([&] { Ask(SessionRequestKind::kCapture); }), HasSubstr("busy"));
}

TEST_F(SessionByRequestTest, ItWaitsForABoardThatAPersonCarries) {
  EverybodyReady();
  world_.silent_at = SessionVerb::kNextPose;
  Ask(SessionRequestKind::kNextPose);
  time_s_ += 10'000;
  Run();
  EXPECT_EQ(Counter(node_.GetStatus(), "waits for pose"), 1);
  Ask(SessionRequestKind::kPoseIsSet);
  Run();
  EXPECT_EQ(Counter(node_.GetStatus(), "busy"), 0);
}

TEST_F(SessionByRequestTest, CornersPickedLaterAreWrittenToTheViewAndSolvedWith) {
  EverybodyReady();
  Ask(SessionRequestKind::kCapture);
  Run();
  Ask(SessionRequestKind::kCapture);
  Run();
  const Session session = OpenSession(dir_ / "session");
  const View before = ReadView(session, "0001");
  const SessionCommand capture = world_.commands[2];
  ASSERT_EQ(capture.verb, SessionVerb::kCapture);
  CornerSelection picks;
  picks.camera = "thermal";
  picks.utime = world_.now;
  picks.image_utime = before.images[1].utime;
  picks.corners = {{{1, 1}, {9, 1}, {9, 9}, {1, 9}}};
  const std::size_t commands = world_.commands.size();
  node_.Handle(picks);
  Run();
  EXPECT_EQ(world_.commands.size(), commands) << "the detector has not looked again yet";
  node_.Handle(world_.Event(capture, "detector"));
  Run();
  ASSERT_EQ(world_.commands.size(), commands + 2);
  EXPECT_EQ(world_.commands[commands].verb, SessionVerb::kSolve);
  const View after = ReadView(session, "0001");
  ASSERT_EQ(after.picks.size(), 1U);
  EXPECT_EQ(after.picks[0].corners, picks.corners);
  EXPECT_EQ(after.cloud.points.size(), before.cloud.points.size());
  EXPECT_EQ(after.images.size(), before.images.size());
  EXPECT_TRUE(ReadView(session, "0002").picks.empty());
}

TEST_F(SessionByRequestTest, CornersPickedDuringAnotherCaptureAreNotLost) {
  EverybodyReady();
  Ask(SessionRequestKind::kCapture);
  Run();
  const Session session = OpenSession(dir_ / "session");
  CornerSelection picks;
  picks.camera = "rgb";
  picks.image_utime = ReadView(session, "0001").images[0].utime;
  picks.corners = {{{1, 1}, {9, 1}, {9, 9}, {1, 9}}};
  const SessionCommand capture = world_.commands[2];
  Ask(SessionRequestKind::kCapture);
  const auto sweep = Only<SessionCommand>(test::AdvanceTo(time_s_ += 1, &node_));
  ASSERT_EQ(sweep.size(), 1U);
  node_.Handle(picks);
  node_.Handle(world_.Event(capture, "detector"));
  EXPECT_EQ(ReadView(session, "0001").picks.size(), 1U);
  const std::size_t before = world_.commands.size();
  test::HandleAll(&node_, world_.Answer(sweep[0]));
  Run();
  const std::vector<SessionVerb> all = Verbs();
  const std::vector<SessionVerb> verbs(all.begin() + static_cast<std::ptrdiff_t>(before) + 1,
                                       all.end());
  EXPECT_THAT(verbs, ElementsAre(SessionVerb::kCapture, SessionVerb::kSolve, SessionVerb::kEvaluate,
                                 SessionVerb::kSolve, SessionVerb::kEvaluate));
}

TEST(SessionByScriptTest, APersonMaySayThatTheBoardStandsAndNothingElse) {
  const test::TempDir dir;
  SessionNode node(test::Script({SessionStep::Kind::kNextPose, SessionStep::Kind::kSweep}),
                   TinyRig(), dir / "session", {});
  for (const char* process : {"assembler", "detector", "solver", "fuser"}) {
    node.Handle(test::Ready(process));
  }
  test::AdvanceTo(0, &node);
  SessionRequest request;
  request.request = SessionRequestKind::kCapture;
  EXPECT_THAT(ErrorOf([&] { node.Handle(request); }), HasSubstr("a script leads"));
  EXPECT_EQ(Counter(node.GetStatus(), "step"), 1);
  EXPECT_EQ(Counter(node.GetStatus(), "steps"), 2);
  request.request = SessionRequestKind::kPoseIsSet;
  node.Handle(request);
  EXPECT_EQ(Only<SessionCommand>(test::AdvanceTo(1, &node)).at(0).verb, SessionVerb::kSweep);
}

}  // namespace
}  // namespace rgbdt
