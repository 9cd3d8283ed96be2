// A solver that is killed and started anew in the midst of a session: session and solver on the
// in-memory bus, everybody else made up.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "calib/files/atomic_file.h"
#include "services/nodes/session_node.h"
#include "services/nodes/solver_node.h"
#include "tests/nodes/bus_process.h"
#include "tests/nodes/session_world.h"
#include "tests/unit/files/test_data.h"
#include "tests/unit/solve/board_world.h"

namespace rgbdt {
namespace {

using test::Step;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Kind = SessionStep::Kind;
using Verb = SessionVerb;

constexpr int kViews = 6;

const BoardWorld& Boards() {
  static const BoardWorld world = MakeBoardWorld(kViews);
  return world;
}

const Rig& OneCamera() {
  static const Rig rig = [] {
    Rig one = simulate::Simulator(test::TinyOptions()).rig();
    CameraSpec camera = Boards().spec;
    camera.camera_from_lidar_guess = GuessOff(Boards().camera_from_lidar, 0.02, 0.03, 5);
    camera.format = one.cameras[0].format;
    one.cameras = {camera};
    return ParseRig(PrintRig(one), "test rig");
  }();
  return rig;
}

CalibrateOptions ByPaper() {
  CalibrateOptions options;
  options.method = kPaperMethod;
  return options;
}

SessionScript ManyViews() {
  SessionScript script;
  for (int i = 0; i < kViews; ++i) {
    for (const Kind kind : {Kind::kNextPose, Kind::kSweep, Kind::kCapture}) {
      script.steps.push_back(Step(kind));
    }
  }
  for (const Kind kind : {Kind::kSolve, Kind::kEvaluate, Kind::kSave}) {
    script.steps.push_back(Step(kind));
  }
  return script;
}

using Solver = test::Process<SolverNode>;

// The simulator, assembler, detector and fuser of a session of the boards' views.
class RestartWorld {
 public:
  using OnCommand = std::function<void(const SessionCommand&, RestartWorld*)>;

  RestartWorld(const std::filesystem::path& directory, OnCommand on_command)
      : on_command_(std::move(on_command)),
        session_(&bus_, ManyViews(), OneCamera(), directory, SessionNode::OnProgress()) {
    StartSolver();
    bus_.Subscribe("SESSION_COMMAND",
                   [this](const std::string& channel, const std::uint8_t* data, std::size_t size) {
                     Answer(std::get<SessionCommand>(Decode(channel, data, size)));
                   });
    session_.runner.SetProblemHandler(
        [this](const std::string& problem) { problems_.push_back(problem); });
  }

  void Run() {
    for (int turn = 0; turn < 600 && !session_.node.finished(); ++turn) {
      const Utime now = turn * kMicrosecondsPerSecond / 10;
      if (turn == starts_solver_at_) StartSolver();
      for (const char* process : {"assembler", "detector", "fuser"}) {
        if (turn % 10 == 0) Send(test::Ready(process));
      }
      session_.runner.Advance(now);
      if (solver_) solver_->runner.Advance(now);
      bus_.Run();
      turn_ = turn;
    }
  }

  void KillSolver() { solver_.reset(); }
  void StartSolver() { solver_ = std::make_unique<Solver>(&bus_, ByPaper()); }
  void StartSolverInSeconds(int seconds) { starts_solver_at_ = turn_ + 10 * seconds; }
  void Send(const Message& message) { bus_.Publish(ChannelOf(message), Encode(message)); }
  void LeaveOut(const std::string& view) {
    LeftOutViews left_out;
    left_out.views = {view};
    Send(left_out);
  }

  const SessionNode& session() const { return session_.node; }
  const Solver& solver() const { return *solver_; }
  const std::vector<std::string>& problems() const { return problems_; }

 private:
  void Answer(const SessionCommand& command) {
    on_command_(command, this);
    if (command.verb == Verb::kNextPose) Send(world_.Event(command, "simulator"));
    if (command.verb != Verb::kSweep && command.verb != Verb::kCapture) return;
    for (const Message& message : world_.Answer(command)) {
      if (command.verb == Verb::kSweep) Send(message);
    }
    if (command.verb != Verb::kCapture) return;
    Send(test::Blank(OneCamera().cameras[0], world_.now));
    ViewDetection detection = Boards().views.at(static_cast<std::size_t>(captures_));
    detection.view = command.view;
    detection.sweep_utime = command.sweep_utime;
    detection.seq = captures_++;
    detection.images[0].utime = world_.now;
    detection.cloud.candidates[0].normal = {-1, 0, 0};
    Send(detection);
    Send(world_.Event(command, "detector"));
  }

  OnCommand on_command_;
  MemoryBus bus_;
  test::World world_;
  test::Process<SessionNode> session_;
  std::unique_ptr<Solver> solver_;
  std::vector<std::string> problems_;
  int captures_ = 0, turn_ = 0, starts_solver_at_ = -1;
};

class SolverRestartTest : public ::testing::Test {
 protected:
  // The calibration of a session in which this happens; empty: it failed.
  std::string CalibrationOf(const std::string& name, RestartWorld::OnCommand happens) {
    world_ = std::make_unique<RestartWorld>(dir_ / name, std::move(happens));
    world_->Run();
    EXPECT_TRUE(world_->session().finished()) << name;
    EXPECT_EQ(world_->session().failure(), "") << name;
    return ReadWholeFile(dir_ / name / "calibration.textproto");
  }
  std::string Undisturbed() {
    const std::string calibration = CalibrationOf("whole", [](auto&&...) {});
    EXPECT_THAT(world_->problems(), ElementsAre());
    return calibration;
  }
  // From the moment on at which this is asked for view `view`, for some seconds.
  static RestartWorld::OnCommand DeadFrom(Verb verb, const std::string& view, int seconds) {
    return [=, done = false](const SessionCommand& command, RestartWorld* world) mutable {
      if (done || command.verb != verb || command.view != view) return;
      done = true;
      world->KillSolver();
      world->StartSolverInSeconds(seconds);
    };
  }

  test::TempDir dir_;
  std::unique_ptr<RestartWorld> world_;
};

TEST_F(SolverRestartTest, BetweenViewsItTakesUpWhereItWas) {
  const std::string expected = Undisturbed();
  const auto at_once = [done = false](const SessionCommand& command, RestartWorld* world) mutable {
    if (done || command.verb != Verb::kNextPose || command.view != "0004") return;
    done = true;
    world->KillSolver();
    world->StartSolver();
  };
  EXPECT_EQ(CalibrationOf("at_once", at_once), expected);
  EXPECT_EQ(world_->solver().node.report()->detections.size(), static_cast<std::size_t>(kViews));
  EXPECT_THAT(world_->problems(), ElementsAre(HasSubstr("rgbdt-solver")));
  EXPECT_EQ(world_->solver().runner.gaps(), 0) << "what is repeated keeps its number";
}

TEST_F(SolverRestartTest, AwayWhileViewsAreTaken) {
  const std::string expected = Undisturbed();
  EXPECT_EQ(CalibrationOf("away", DeadFrom(Verb::kCapture, "0002", 1)), expected);
  EXPECT_EQ(CalibrationOf("last", DeadFrom(Verb::kCapture, "0006", 3)), expected);
}

TEST_F(SolverRestartTest, AwayWhenItIsAskedItIsAskedAgain) {
  const std::string expected = Undisturbed();
  EXPECT_EQ(CalibrationOf("solve", DeadFrom(Verb::kSolve, "0006", 2)), expected);
  EXPECT_EQ(CalibrationOf("evaluate", DeadFrom(Verb::kEvaluate, "0006", 2)), expected);
}

// It comes up between its last view and the question: no STATUS tells before it answers.
TEST_F(SolverRestartTest, AnAnswerFromFewerViewsIsNoAnswer) {
  const std::string expected = Undisturbed();
  const auto before = [done = false](const SessionCommand& command, RestartWorld* world) mutable {
    if (done || command.verb != Verb::kCapture || command.view != "0006") return;
    done = true;
    world->KillSolver();
    world->StartSolver();
    world->Send(test::TextOf(OneCamera()));
  };
  EXPECT_EQ(CalibrationOf("before", before), expected);
}

TEST_F(SolverRestartTest, WhatAPersonLeftOutStaysLeftOut) {
  const auto leave_out = [](const SessionCommand& command, RestartWorld* world) {
    if (command.verb == Verb::kNextPose && command.view == "0003") world->LeaveOut("0001");
  };
  const std::string expected = CalibrationOf("left_out", leave_out);
  const auto kill = DeadFrom(Verb::kNextPose, "0005", 1);
  EXPECT_EQ(CalibrationOf("killed",
                          [=](const SessionCommand& command, RestartWorld* world) mutable {
                            leave_out(command, world);
                            kill(command, world);
                          }),
            expected);
  EXPECT_NE(expected, Undisturbed());
}

}  // namespace
}  // namespace rgbdt
