#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

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

// A disk on which no view can be written for a while: a file is where their folder is to be.
class FullDisk {
 public:
  explicit FullDisk(const std::filesystem::path& session) : session_(session) {}
  void Fill() {
    std::filesystem::create_directories(session_ / "views");
    std::filesystem::rename(session_ / "views", session_ / "away");
    test::WriteQuickly(session_ / "views", "");
  }
  void MakeRoom() {
    std::filesystem::remove(session_ / "views");
    std::filesystem::rename(session_ / "away", session_ / "views");
  }

 private:
  std::filesystem::path session_;
};

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
        if (before_answer_) before_answer_(command);
        test::HandleAll(&node_, world_.Answer(command));
      }
    }
  }
  std::size_t HowOftenTold(const std::string& text) const {
    return static_cast<std::size_t>(std::count_if(
        events_.begin(), events_.end(),
        [&](const SessionEvent& event) { return event.text.find(text) != std::string::npos; }));
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
  FullDisk disk_{dir_ / "session"};
  std::function<void(const SessionCommand&)> before_answer_;
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

TEST_F(SessionByRequestTest, AViewThatCannotBeWrittenIsKeptInMemoryUntilItCan) {
  EverybodyReady();
  before_answer_ = [&](const SessionCommand& command) {
    if (command.verb == SessionVerb::kCapture) disk_.Fill();
  };
  Ask(SessionRequestKind::kCapture);
  for (int minute = 0; minute < 15; ++minute) Run();  // longer than a step may take
  EXPECT_EQ(Counter(node_.GetStatus(), "busy"), 1);
  EXPECT_THAT(node_.GetStatus().text, HasSubstr("view 0001 is kept in memory: cannot"));
  EXPECT_EQ(HowOftenTold("view 0001 is kept in memory"), 1U);
  EXPECT_THAT(ErrorOf([&] { Ask(SessionRequestKind::kFinish); }),
              AllOf(HasSubstr("busy"), HasSubstr("view 0001 is kept in memory")));
  const std::size_t asked = world_.commands.size();
  disk_.MakeRoom();
  Run();
  EXPECT_EQ(Counter(node_.GetStatus(), "busy"), 0);
  EXPECT_EQ(HowOftenTold("what was kept in memory is on disk"), 1U);
  EXPECT_EQ(node_.failure(), "");
  EXPECT_THAT(OpenSession(dir_ / "session").views, ElementsAre("0001"));
  EXPECT_TRUE(std::filesystem::exists(dir_ / "session/views/0001/detection.lcm"));
  const std::vector<SessionVerb> all = Verbs();
  EXPECT_THAT(std::vector<SessionVerb>(all.begin() + static_cast<std::ptrdiff_t>(asked), all.end()),
              ElementsAre(SessionVerb::kSolve, SessionVerb::kEvaluate));
}

TEST_F(SessionByRequestTest, WhereNoViewCanBeWrittenACaptureIsRefusedBeforeItsSweep) {
  EverybodyReady();
  Ask(SessionRequestKind::kCapture);
  Run();
  disk_.Fill();
  const std::size_t asked = world_.commands.size();
  Ask(SessionRequestKind::kCapture);
  Run();
  EXPECT_EQ(world_.commands.size(), asked);
  EXPECT_EQ(events_.back().kind, EventKind::kFailed);
  EXPECT_THAT(events_.back().text,
              AllOf(HasSubstr("sweep: no view is taken: cannot write"), HasSubstr("make room")));
  disk_.MakeRoom();
  Ask(SessionRequestKind::kCapture);
  Run();
  EXPECT_EQ(node_.failure(), "");
  EXPECT_THAT(OpenSession(dir_ / "session").views, ElementsAre("0001", "0002"));
}

// The view is not on disk yet; so are the picks.
TEST_F(SessionByRequestTest, CornersPickedInAViewThatIsKeptInMemoryAreWrittenWithIt) {
  EverybodyReady();
  CornerSelection picks;
  picks.camera = "rgb";
  picks.corners = {{{1, 1}, {9, 1}, {9, 9}, {1, 9}}};
  before_answer_ = [&](const SessionCommand& command) {
    if (command.verb != SessionVerb::kCapture) return;
    disk_.Fill();
    picks.image_utime = world_.now + kMicrosecondsPerSecond;  // as World stamps it
  };
  Ask(SessionRequestKind::kCapture);
  Run();
  node_.Handle(picks);
  disk_.MakeRoom();
  Run();
  const View view = ReadView(OpenSession(dir_ / "session"), "0001");
  ASSERT_EQ(view.picks.size(), 1U);
  EXPECT_EQ(view.picks[0].corners, picks.corners);
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
  test::HandleAll(&node_, world_.Detect(capture));
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

// As where the command came twice (AnsweredCommands).
TEST_F(SessionByRequestTest, ADetectorsLastWordThatIsSaidAgainAsksForNothing) {
  EverybodyReady();
  Ask(SessionRequestKind::kCapture);
  Run();
  const SessionCommand capture = world_.commands[2];
  ASSERT_EQ(capture.verb, SessionVerb::kCapture);
  const std::size_t commands = world_.commands.size();
  node_.Handle(world_.Event(capture, "detector"));
  Run();
  EXPECT_EQ(world_.commands.size(), commands);
  EXPECT_EQ(HowOftenTold("once more"), 0U);
  test::HandleAll(&node_, world_.Detect(capture));
  node_.Handle(world_.Event(capture, "detector"));
  Run();
  EXPECT_EQ(world_.commands.size(), commands + 2) << "solve and evaluate, once";
  EXPECT_EQ(HowOftenTold("once more"), 1U);
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
  test::HandleAll(&node_, world_.Detect(capture));
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

// The disk is full once before a sweep and once before a view is written.
TEST(SessionByScriptTest, ItWaitsForRoomOnTheDiskAndGoesOn) {
  for (const SessionVerb full_at : {SessionVerb::kNextPose, SessionVerb::kCapture}) {
    const test::TempDir dir;
    test::World world;
    FullDisk disk(dir / "session");
    using Kind = SessionStep::Kind;
    SessionNode node(test::Script({Kind::kNextPose, Kind::kSweep, Kind::kCapture, Kind::kSolve,
                                   Kind::kEvaluate, Kind::kSave}),
                     TinyRig(), dir / "session", {});
    for (const char* process : {"assembler", "detector", "solver", "fuser"}) {
      node.Handle(test::Ready(process));
    }
    double full_since = -1;
    const double full_for = full_at == SessionVerb::kCapture ? 300 : 8;  // of a sweep's 10 s
    std::string told;
    for (double t = 0; t < 400 && !node.finished(); t += 0.5) {
      if (full_since >= 0 && t == full_since + full_for) {
        told = node.GetStatus().text;
        disk.MakeRoom();
      }
      for (const SessionCommand& command : Only<SessionCommand>(test::AdvanceTo(t, &node))) {
        if (command.verb == full_at && full_since < 0) {
          full_since = t;
          disk.Fill();
        }
        test::HandleAll(&node, world.Answer(command));
      }
    }
    EXPECT_TRUE(node.finished());
    EXPECT_EQ(node.failure(), "");
    EXPECT_EQ(world.commands.size(), 6U) << "nothing is asked for twice";
    EXPECT_THAT(OpenSession(dir / "session").views, ElementsAre("0001"));
    EXPECT_TRUE(std::filesystem::exists(dir / "session/calibration.textproto"));
    EXPECT_EQ(told.find("is kept in memory") != std::string::npos,
              full_at == SessionVerb::kCapture);
  }
}

TEST(SessionByScriptTest, AFailureSaysWhatIsOnDisk) {
  const test::TempDir dir;
  test::World world;
  using Kind = SessionStep::Kind;
  SessionScript script = test::Script({});
  for (int view = 0; view < 4; ++view) {
    for (const Kind kind : {Kind::kNextPose, Kind::kSweep, Kind::kCapture}) {
      script.steps.push_back(test::Step(kind));
    }
  }
  SessionNode node(script, TinyRig(), dir / "session", {});
  for (const char* process : {"assembler", "detector", "solver", "fuser"}) {
    node.Handle(test::Ready(process));
  }
  for (double t = 0; t < 60 && !node.finished(); t += 0.5) {
    for (const SessionCommand& command : Only<SessionCommand>(test::AdvanceTo(t, &node))) {
      if (command.view == "0004") world.silent_at = SessionVerb::kSweep;
      test::HandleAll(&node, world.Answer(command));
    }
  }
  EXPECT_THAT(node.failure(), AllOf(HasSubstr("no answer in 10 s"),
                                    HasSubstr("rgbdt calibrate " + (dir / "session").string() +
                                              " takes the 3 views that are on disk")));
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
