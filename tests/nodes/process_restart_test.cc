// A process that takes part in a view is killed, and is back some seconds later: what it was asked
// it is asked again.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calib/files/atomic_file.h"
#include "tests/nodes/restart_world.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using test::RestartWorld;
using ::testing::AllOf;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Verb = SessionVerb;

class ProcessRestartTest : public ::testing::Test {
 protected:
  // When this is asked for view 0003, `times` times.
  static RestartWorld::OnCommand At(Verb verb, const std::string& process, int seconds,
                                    int times = 1) {
    return [=](const SessionCommand& command, RestartWorld* world) mutable {
      if (times == 0 || command.verb != verb || command.view != "0003") return;
      --times;
      world->Kill(process, seconds);
    };
  }
  void Run(const std::string& name, RestartWorld::OnCommand happens) {
    world_ = std::make_unique<RestartWorld>(dir_ / name, std::move(happens));
    world_->Run();
    EXPECT_TRUE(world_->session().finished()) << name;
  }
  std::string CalibrationOf(const std::string& name, RestartWorld::OnCommand happens) {
    Run(name, std::move(happens));
    EXPECT_EQ(world_->session().failure(), "") << name;
    return ReadWholeFile(dir_ / name / "calibration.textproto");
  }
  int Asked(Verb verb) const {
    const auto& all = world_->commands();
    return static_cast<int>(std::count_if(all.begin(), all.end(), [&](const SessionCommand& c) {
      return c.verb == verb && c.view == "0003";
    }));
  }

  test::TempDir dir_;
  double cut_at_ = 0;  // [s]
  std::unique_ptr<RestartWorld> world_;
};

TEST_F(ProcessRestartTest, WhoeverIsKilledWhateverWasAskedTheCalibrationIsTheSame) {
  const std::string expected = CalibrationOf("whole", [](auto&&...) {});
  const double undisturbed_s = world_->seconds();
  EXPECT_THAT(world_->problems(), IsEmpty());
  for (const Verb verb : {Verb::kNextPose, Verb::kSweep, Verb::kCapture}) {
    for (const char* process : {"simulator", "assembler", "detector", "fuser"}) {
      const std::string name = std::string(process) + std::to_string(static_cast<int>(verb));
      EXPECT_EQ(CalibrationOf(name, At(verb, process, 2)), expected) << name;
      EXPECT_LT(world_->seconds(), undisturbed_s + 6) << name << ": no time-out is waited for";
    }
  }
}

TEST_F(ProcessRestartTest, WhoeverIsCutOffWhateverWasAskedTheCalibrationIsTheSame) {
  const std::string expected = CalibrationOf("whole", [](auto&&...) {});
  const double undisturbed_s = world_->seconds();
  for (const Verb verb : {Verb::kNextPose, Verb::kSweep, Verb::kCapture}) {
    for (const char* process : {"simulator", "assembler", "detector"}) {
      const std::string name = std::string(process) + std::to_string(static_cast<int>(verb));
      const auto cut = [this, verb, process](const SessionCommand& command, RestartWorld* world) {
        if (command.verb != verb || command.view != "0003" || world->seconds() > cut_at_) return;
        cut_at_ = world->seconds();
        world->CutOff(process, 5);
      };
      cut_at_ = 1e9;
      EXPECT_EQ(CalibrationOf(name, cut), expected) << name;
      EXPECT_LT(world_->seconds(), undisturbed_s + 5 + 6) << name << ": no time-out is waited for";
    }
  }
}

TEST_F(ProcessRestartTest, ACommandIsRepeatedAsItWasUntilItIsAnswered) {
  std::vector<SessionCommand> of_view;
  int unanswered = 0;
  Run("deaf", [&](const SessionCommand& command, RestartWorld* world) {
    if (command.verb != Verb::kNextPose || command.view != "0003") return;
    of_view.push_back(command);
    if (++unanswered < 3) world->CutOff("simulator", 1);  // too short to be noticed
  });
  EXPECT_EQ(world_->session().failure(), "");
  ASSERT_EQ(of_view.size(), 3U);
  EXPECT_EQ(of_view[0].command, of_view[2].command);
  EXPECT_EQ(of_view[0].utime, of_view[2].utime);
}

TEST_F(ProcessRestartTest, WhoTakesNoPartCostsNothing) {
  Run("fuser", At(Verb::kSweep, "fuser", 1));
  EXPECT_EQ(Asked(Verb::kSweep), 1);
  EXPECT_THAT(world_->problems(), IsEmpty());
}

TEST_F(ProcessRestartTest, ADetectorThatDiesIsToldTheViewAgain) {
  for (const Verb verb : {Verb::kSweep, Verb::kCapture}) {
    const std::string name = "detector" + std::to_string(static_cast<int>(verb));
    Run(name, At(verb, "detector", 2));
    EXPECT_EQ(world_->session().failure(), "");
    EXPECT_EQ(Asked(Verb::kNextPose), 1);
    EXPECT_EQ(Asked(Verb::kSweep), 1);
    EXPECT_EQ(Asked(Verb::kCapture), 2) << "as it was, for one that has not heard it";
    EXPECT_THAT(world_->problems(),
                ElementsAre(AllOf(HasSubstr("view 0003: rgbdt-detector was started anew"),
                                  HasSubstr("it is told the view again"))));
  }
}

// Of what it was told, perhaps.
TEST_F(ProcessRestartTest, OneThatDiesAgainGetsAnotherSweep) {
  Run("detector", At(Verb::kCapture, "detector", 2, 2));
  EXPECT_EQ(world_->session().failure(), "");
  EXPECT_EQ(Asked(Verb::kSweep), 2);
  EXPECT_THAT(world_->problems(), ElementsAre(HasSubstr("it is told the view again"),
                                              HasSubstr("the sweep is taken again")));
}

TEST_F(ProcessRestartTest, ASweepThatOthersMakeGoesOnAndIsThenMadeAgain) {
  Run("assembler", At(Verb::kSweep, "assembler", 1));
  EXPECT_EQ(Asked(Verb::kSweep), 2);
}

TEST_F(ProcessRestartTest, OneThatDiesEachTimeIsNamedAtLast) {
  Run("detector", At(Verb::kCapture, "detector", 1, 100));
  EXPECT_EQ(Asked(Verb::kCapture), 2 * (SessionNode::kMaxRestarts + 1));
  EXPECT_THAT(world_->session().failure(),
              AllOf(HasSubstr("view 0003"), HasSubstr("rgbdt-detector was started anew"),
                    HasSubstr("given up after 6 sweeps")));
  Run("simulator", At(Verb::kNextPose, "simulator", 1, 100));
  EXPECT_THAT(world_->session().failure(), HasSubstr("rgbdt-simulator was started anew 6 times"));
}

// Told by STATUS alone: an older one that comes late, or twice, is no other process.
TEST_F(ProcessRestartTest, NoSweepBeginsUntilEverybodyIsReady) {
  SessionNode node(test::ManyViews(), test::OneCamera(), dir_ / "session", {});
  for (const char* process : {"assembler", "detector", "solver", "fuser"}) {
    node.Handle(test::Ready(process));
  }
  const auto reset_and_pose = test::Only<SessionCommand>(test::AdvanceTo(0, &node));
  ASSERT_EQ(reset_and_pose.size(), 2U);
  node.Handle(test::Ready("detector", "waits for the rig (RIG)", false));
  node.Handle(test::World().Event(reset_and_pose[1], "simulator"));
  EXPECT_THAT(test::Only<SessionCommand>(test::AdvanceTo(1, &node)), IsEmpty());
  EXPECT_THAT(test::Only<SessionCommand>(test::AdvanceTo(10, &node)), IsEmpty());
  node.Handle(test::Ready("detector"));
  const auto sweep = test::Only<SessionCommand>(test::AdvanceTo(10.5, &node));
  ASSERT_EQ(sweep.size(), 1U);
  EXPECT_EQ(sweep[0].verb, Verb::kSweep);
}

TEST_F(ProcessRestartTest, OneThatDoesNotBecomeReadyIsNamed) {
  SessionNode node(test::ManyViews(), test::OneCamera(), dir_ / "session", {});
  for (const char* process : {"assembler", "detector", "solver", "fuser"}) {
    node.Handle(test::Ready(process));
  }
  const auto commands = test::Only<SessionCommand>(test::AdvanceTo(0, &node));
  node.Handle(test::Ready("detector", "waits for the rig (RIG)", false));
  node.Handle(test::World().Event(commands.back(), "simulator"));
  for (int s = 1; s < 13; ++s) test::AdvanceTo(s, &node);
  EXPECT_TRUE(node.finished());
  EXPECT_THAT(node.failure(), AllOf(HasSubstr("sweep"), HasSubstr("not ready after 10 s"),
                                    HasSubstr("rgbdt-detector (waits for the rig (RIG))")));
}

}  // namespace
}  // namespace rgbdt
