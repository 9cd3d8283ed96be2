// A solver that is killed and started anew in the midst of a session: session and solver on the
// in-memory bus, everybody else made up.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "calib/files/atomic_file.h"
#include "tests/nodes/restart_world.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using test::kViews;
using test::OneCamera;
using test::RestartWorld;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Verb = SessionVerb;

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

TEST(SolverViews, ThoseThatItStillTakesAreNotLost) {
  SolverViews views;
  for (const char* view : {"0001", "0002", "0003"}) {
    ViewDetection detection;
    detection.view = view;
    views.Add(detection);
  }
  const auto lost = [&](std::int64_t counted) {
    Status status = test::Ready("solver");
    status.counters = {{"views", counted}};
    return views.LostBy(status);
  };
  EXPECT_FALSE(lost(0)) << "none was there at a STATUS before";
  EXPECT_FALSE(lost(1));
  EXPECT_FALSE(lost(2));
  EXPECT_TRUE(lost(2)) << "the third is lost";
  EXPECT_FALSE(lost(3));
  EXPECT_TRUE(lost(0)) << "it was started anew";
}

}  // namespace
}  // namespace rgbdt
