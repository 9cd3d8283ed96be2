// A session that is killed and started again on its own folder.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "calib/files/atomic_file.h"
#include "calib/files/session/session_dir.h"
#include "tests/nodes/restart_world.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using test::kViews;
using test::OneCamera;
using test::Only;
using test::RestartWorld;
using test::TinyRig;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Kind = SessionStep::Kind;
using Verb = SessionVerb;

namespace fs = std::filesystem;

class SessionResumeTest : public ::testing::Test {
 protected:
  std::string CalibrationOf(const std::string& name, RestartWorld::OnCommand happens) {
    world_ = std::make_unique<RestartWorld>(dir_ / name, std::move(happens));
    world_->Run();
    EXPECT_TRUE(world_->session().finished()) << name;
    EXPECT_EQ(world_->session().failure(), "") << name;
    EXPECT_EQ(OpenSession(dir_ / name).views.size(), static_cast<std::size_t>(kViews)) << name;
    return ReadWholeFile(dir_ / name / "calibration.textproto");
  }
  std::string Undisturbed() {
    return CalibrationOf("whole", [](auto&&...) {});
  }
  // Once, when this is asked for this view.
  static RestartWorld::OnCommand At(Verb verb, const std::string& view,
                                    std::function<void(RestartWorld*)> happens) {
    return [=, done = false](const SessionCommand& command, RestartWorld* world) mutable {
      if (done || command.verb != verb || command.view != view) return;
      done = true;
      happens(world);
    };
  }
  std::vector<SessionCommand> Asked(Verb verb, const std::string& view) const {
    std::vector<SessionCommand> asked;
    for (const SessionCommand& command : world_->commands()) {
      if (command.verb == verb && command.view == view) asked.push_back(command);
    }
    return asked;
  }
  // A session that was ended after its second view.
  fs::path TwoViews() {
    RestartWorld world(dir_ / "two",
                       At(Verb::kNextPose, "0003", [](RestartWorld* w) { w->KillSession(1000); }));
    world.Run();
    EXPECT_THAT(OpenSession(dir_ / "two").views, ElementsAre("0001", "0002"));
    return dir_ / "two";
  }
  // Why a session by this script is refused on a folder that has two views.
  static std::string Refusal(const SessionScript& script, const Rig& rig, const fs::path& folder) {
    const auto before = Contents(folder);
    const std::string why = test::ErrorOf([&] { SessionNode node(script, rig, folder, {}); });
    EXPECT_EQ(Contents(folder), before);
    return why;
  }
  static std::map<std::string, std::string> Contents(const fs::path& folder) {
    std::map<std::string, std::string> contents;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.is_regular_file()) contents[entry.path()] = ReadWholeFile(entry.path());
    }
    return contents;
  }

  test::TempDir dir_;
  std::unique_ptr<RestartWorld> world_;
};

TEST_F(SessionResumeTest, AtWhateverCommandItIsKilledTheCalibrationIsTheSame) {
  const std::string expected = Undisturbed();
  const std::vector<std::pair<Verb, std::string>> moments = {
      {Verb::kReset, ""},        {Verb::kNextPose, "0001"}, {Verb::kCapture, "0001"},
      {Verb::kNextPose, "0004"}, {Verb::kSweep, "0004"},    {Verb::kCapture, "0004"},
      {Verb::kCapture, "0006"},  {Verb::kSolve, "0006"},    {Verb::kEvaluate, "0006"}};
  int number = 0;
  for (const auto& [verb, view] : moments) {
    const std::string name = std::to_string(++number);
    EXPECT_EQ(CalibrationOf(name, At(verb, view, [](RestartWorld* w) { w->KillSession(2); })),
              expected)
        << name;
  }
}

// Who is at it, or has done it, answers; what of the view is lost with the session the detector
// has.
TEST_F(SessionResumeTest, WhatItAskedForIsAskedAsItWasAndNothingIsTakenAgain) {
  const std::string expected = Undisturbed();
  for (const std::string view : {"0001", "0003"}) {
    for (const Verb verb : {Verb::kNextPose, Verb::kSweep, Verb::kCapture}) {
      const std::string name = view + std::to_string(static_cast<int>(verb));
      EXPECT_EQ(CalibrationOf(name, At(verb, view, [](RestartWorld* w) { w->KillSession(2); })),
                expected);
      for (const Verb asked : {Verb::kNextPose, Verb::kSweep, Verb::kCapture}) {
        const std::vector<SessionCommand> commands = Asked(asked, view);
        ASSERT_EQ(commands.size(), asked == verb ? 2U : 1U) << name;
        EXPECT_EQ(commands[0].command, commands.back().command);
        EXPECT_EQ(commands[0].utime, commands.back().utime);
      }
      EXPECT_EQ(Asked(Verb::kSayView, view).size(), verb == Verb::kCapture ? 1U : 0U) << name;
      EXPECT_EQ(Asked(Verb::kReset, "").size(), 1U) << name;
    }
  }
}

TEST_F(SessionResumeTest, WhatWasAskedForLongAgoIsAskedAnew) {
  CalibrationOf("old", At(Verb::kCapture, "0003", [&](RestartWorld* world) {
                  const fs::path asked = dir_ / "old/asked.lcm";
                  fs::last_write_time(
                      asked, fs::last_write_time(asked) - std::chrono::seconds(kAskedIsOld + 10));
                  world->KillSession(1);
                }));
  const std::vector<SessionCommand> poses = Asked(Verb::kNextPose, "0003");
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_NE(poses[0].command, poses[1].command);
}

// Nobody waits for what a session that was told to end, or has failed, asked for.
TEST_F(SessionResumeTest, OneThatWasToldToEndLeavesNothingAsked) {
  SessionNode node(test::ManyViews(), OneCamera(), dir_ / "session", {});
  for (const char* process : {"assembler", "detector", "solver", "fuser"}) {
    node.Handle(test::Ready(process));
  }
  test::AdvanceTo(0, &node);
  EXPECT_TRUE(fs::exists(dir_ / "session/asked.lcm"));
  EXPECT_EQ(node.WriteWhatIsKept(), "");
  EXPECT_FALSE(fs::exists(dir_ / "session/asked.lcm"));
}

TEST_F(SessionResumeTest, AgainAndAgainAndTheSolverWithIt) {
  const std::string expected = Undisturbed();
  std::set<std::string> killed;
  const auto at_each_view = [&](const SessionCommand& command, RestartWorld* world) {
    if (command.verb != Verb::kSweep || !killed.insert(command.view).second) return;
    world->KillSession(1);
    world->KillSolver();
    world->StartSolver();
  };
  EXPECT_EQ(CalibrationOf("killed", at_each_view), expected);
  EXPECT_EQ(killed.size(), static_cast<std::size_t>(kViews));
  EXPECT_THAT(world_->problems(), Contains(HasSubstr("goes on with the 5 views")));
}

TEST_F(SessionResumeTest, TheViewsThatAreThereAreNotTouched) {
  fs::file_time_type written;
  std::map<std::string, std::string> before;
  CalibrationOf("killed", At(Verb::kNextPose, "0003", [&](RestartWorld* world) {
                  world->KillSession(2);
                  before = Contents(dir_ / "killed/views");
                  written = fs::last_write_time(dir_ / "killed/views/0002/view.textproto");
                }));
  ASSERT_EQ(before.size(), 2 * 4U);  // cloud, image, view, detection
  const auto after = Contents(dir_ / "killed/views");
  for (const auto& [file, content] : before) EXPECT_EQ(after.at(file), content) << file;
  EXPECT_EQ(fs::last_write_time(dir_ / "killed/views/0002/view.textproto"), written);
  std::vector<std::string> poses;
  for (const SessionCommand& command : world_->commands()) {
    if (command.verb == Verb::kNextPose) poses.push_back(command.view);
  }
  EXPECT_THAT(poses, ElementsAre("0001", "0002", "0003", "0003", "0004", "0005", "0006"));
}

// Killed between the view and its detection, or in the midst of writing it.
TEST_F(SessionResumeTest, AViewThatWasNotFinishedIsKeptAndTakenAgain) {
  const std::string expected = Undisturbed();
  const auto unfinished = At(Verb::kNextPose, "0004", [&](RestartWorld* world) {
    world->KillSession(1);
    fs::remove(dir_ / "killed/views/0003/detection.lcm");
    fs::create_directories(dir_ / "killed/views/.0004.part");
    std::ofstream(dir_ / "killed/views/.0004.part/cloud.pcd") << "half a clou";
  });
  EXPECT_EQ(CalibrationOf("killed", unfinished), expected);
  EXPECT_TRUE(fs::exists(dir_ / "killed/views/.0003.unfinished/view.textproto"));
  EXPECT_FALSE(fs::exists(dir_ / "killed/views/.0004.part"));
  EXPECT_THAT(world_->problems(), Contains(AllOf(HasSubstr("view 0003 was not finished"),
                                                 HasSubstr(".0003.unfinished"))));
}

TEST_F(SessionResumeTest, WhatAPersonLeftOutStaysLeftOut) {
  const auto leave_out = [](const SessionCommand& command, RestartWorld* world) {
    if (command.verb == Verb::kNextPose && command.view == "0003") world->LeaveOut("0001");
  };
  const std::string expected = CalibrationOf("left_out", leave_out);
  bool done = false;
  EXPECT_EQ(CalibrationOf("killed",
                          [&](const SessionCommand& command, RestartWorld* world) {
                            if (!done) leave_out(command, world);
                            if (done || command.view != "0005") return;
                            done = true;
                            world->KillSession(1);
                          }),
            expected);
  EXPECT_NE(expected, Undisturbed());
}

TEST_F(SessionResumeTest, AnotherRigIsRefusedAndNamed) {
  Rig other = OneCamera();
  other.cameras[0].lens.fx += 1;
  EXPECT_THAT(Refusal(test::ManyViews(), ParseRig(PrintRig(other), "other"), TwoViews()),
              AllOf(HasSubstr("two/views holds views of an earlier session of another rig"),
                    HasSubstr("fx"), HasSubstr("name another directory")));
  fs::remove(dir_ / "two/rig.textproto");
  EXPECT_THAT(Refusal(test::ManyViews(), OneCamera(), dir_ / "two"),
              AllOf(HasSubstr("earlier session"), HasSubstr("no rig.textproto")));
}

TEST_F(SessionResumeTest, AnotherScriptIsRefusedAndNamed) {
  const fs::path folder = TwoViews();
  SessionScript script = test::ManyViews();
  script.steps[5].heldout = true;
  EXPECT_THAT(Refusal(script, OneCamera(), folder),
              AllOf(HasSubstr("another script"),
                    HasSubstr("view 0002 is not held out, by the script it is")));
  script = test::Script({Kind::kNextPose, Kind::kSweep, Kind::kCapture, Kind::kSolve});
  EXPECT_THAT(Refusal(script, OneCamera(), folder), HasSubstr("view 0002 is there"));
  script = test::Script({Kind::kSweep, Kind::kCapture, Kind::kSweep, Kind::kCapture});
  EXPECT_THAT(Refusal(script, OneCamera(), folder), HasSubstr("nothing is left to do"));
  fs::remove(folder / "views/0001/detection.lcm");
  EXPECT_THAT(Refusal(test::ManyViews(), OneCamera(), folder), HasSubstr("view 0002 is there"));
}

TEST_F(SessionResumeTest, WhatCannotBeReadOrHasEndedIsRefused) {
  const fs::path folder = TwoViews();
  const std::string detection = ReadWholeFile(folder / "views/0001/detection.lcm");
  std::ofstream(folder / "views/0001/detection.lcm") << detection.substr(0, 100);
  EXPECT_THAT(Refusal(test::ManyViews(), OneCamera(), folder),
              HasSubstr("views/0001/detection.lcm is no message of this version"));
  fs::copy_file(folder / "views/0002/detection.lcm", folder / "views/0001/detection.lcm",
                fs::copy_options::overwrite_existing);
  EXPECT_THAT(Refusal(test::ManyViews(), OneCamera(), folder), HasSubstr("is of view \"0002\""));
  std::ofstream(folder / "views/0001/detection.lcm") << detection;
  EXPECT_NO_THROW(SessionNode(test::ManyViews(), OneCamera(), folder, {}));
  std::ofstream(folder / "report.json") << "{}";  // as `rgbdt calibrate` writes it
  EXPECT_NO_THROW(SessionNode(test::ManyViews(), OneCamera(), folder, {}));
  std::ofstream(folder / "ended") << "";
  EXPECT_THAT(Refusal(test::ManyViews(), OneCamera(), folder), HasSubstr("has ended"));
}

// A computer without a clock of its own that was switched off: its time begins anew.
TEST_F(SessionResumeTest, AClockThatIsBehindTheEarlierViewsIsFollowed) {
  const fs::path folder = TwoViews();
  SessionNode node(OneCamera(), folder, {});
  for (const char* process : {"assembler", "detector", "solver", "fuser"}) {
    node.Handle(test::Ready(process));
  }
  test::AdvanceTo(0, &node);
  const auto solve = Only<SessionCommand>(test::AdvanceTo(1, &node));
  ASSERT_EQ(solve.size(), 1U);
  const Utime now = test::kStart - 3600 * kMicrosecondsPerSecond;
  node.Handle(test::Blank(OneCamera().cameras[0], now));
  SessionEvent failed;  // so that it is free again
  failed.source = "somebody";
  failed.command = solve[0].command;
  failed.kind = EventKind::kFailed;
  node.Handle(failed);
  node.Handle(SessionRequest());
  const auto sweep = Only<SessionCommand>(test::AdvanceTo(2, &node));
  ASSERT_EQ(sweep.size(), 1U);
  EXPECT_EQ(sweep[0].verb, Verb::kSweep);
  EXPECT_EQ(sweep[0].utime, now);
}

// One that a person leads: it solves at once from what is there, and asks for the next.
TEST_F(SessionResumeTest, APersonGoesOnWithTheNextView) {
  test::World world;
  std::vector<SessionEvent> events;
  Messages detections;
  const auto run = [&](SessionNode* node, int captures) {
    for (const char* process : {"assembler", "detector", "solver", "fuser"}) {
      node->Handle(test::Ready(process));
    }
    for (int turn = 0; turn < 100; ++turn) {
      const Messages said = test::AdvanceTo(turn / 10.0, node);
      for (const SessionEvent& event : Only<SessionEvent>(said)) events.push_back(event);
      for (const ViewDetection& detection : Only<ViewDetection>(said)) {
        detections.emplace_back(detection);
      }
      for (const SessionCommand& command : Only<SessionCommand>(said)) {
        test::HandleAll(node, world.Answer(command));
      }
      if (test::Counter(node->GetStatus(), "busy") != 0 || captures == 0) continue;
      --captures;
      node->Handle(SessionRequest());
    }
  };
  {
    SessionNode node(TinyRig(), dir_ / "session", {});
    run(&node, 2);
  }
  fs::create_directories(dir_ / "session/views/kitchen");
  world.commands.clear();
  events.clear();
  SessionNode node(TinyRig(), dir_ / "session", {});
  run(&node, 1);
  EXPECT_EQ(node.failure(), "");
  std::vector<Verb> verbs;
  for (const SessionCommand& command : world.commands) verbs.push_back(command.verb);
  EXPECT_THAT(verbs, ElementsAre(Verb::kGoOn, Verb::kSolve, Verb::kEvaluate, Verb::kSweep,
                                 Verb::kCapture, Verb::kSolve, Verb::kEvaluate));
  EXPECT_EQ(detections.size(), 2U);
  EXPECT_THAT(OpenSession(dir_ / "session").views, ElementsAre("0001", "0002", "0003", "kitchen"));
  std::vector<std::string> texts;
  for (const SessionEvent& event : events) texts.push_back(event.text);
  EXPECT_THAT(texts, Contains(HasSubstr("goes on with the 2 views")));
  EXPECT_THAT(texts, Contains(HasSubstr("view kitchen was not detected and does not count")));
}

}  // namespace
}  // namespace rgbdt
