#include "services/nodes/session_node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <cmath>

#include "calib/files/atomic_file.h"
#include "calib/files/schema/calibration_file.h"
#include "calib/files/schema/report_file.h"
#include "calib/files/session/session_dir.h"
#include "calib/model/errors.h"
#include "tests/nodes/nodes_testing.h"
#include "tests/nodes/session_world.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using test::AdvanceTo;
using test::Blank;
using test::ErrorOf;
using test::kStart;
using test::Only;
using test::Ready;
using test::Script;
using test::TinyRig;
using test::World;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using Kind = SessionStep::Kind;

const std::vector<Kind> kOneView = {Kind::kNextPose, Kind::kSweep,    Kind::kCapture,
                                    Kind::kSolve,    Kind::kEvaluate, Kind::kSave};

class SessionNodeTest : public ::testing::Test {
 protected:
  void Start(SessionScript script) {
    node_ =
        std::make_unique<SessionNode>(std::move(script), TinyRig(), dir_ / "session",
                                      [&](const SessionProgress& p) { progress_.push_back(p); });
  }
  void EverybodyReady() {
    for (const char* process : {"assembler", "detector", "solver", "fuser"}) {
      node_->Handle(Ready(process));
    }
  }
  // Until the session ends or a minute of its clock is over.
  void Run() {
    for (double t = 0; t < 60 && !node_->finished(); t += 0.1) {
      if (meanwhile_) meanwhile_();
      for (const SessionCommand& command : Only<SessionCommand>(AdvanceTo(t, node_.get()))) {
        test::HandleAll(node_.get(), world_.Answer(command));
      }
    }
  }

  test::TempDir dir_;
  World world_;
  std::vector<SessionProgress> progress_;
  std::unique_ptr<SessionNode> node_;
  std::function<void()> meanwhile_;  // what happens all the time
};

TEST_F(SessionNodeTest, NamesThatStrangersMakeUpFillNoMemory) {
  Start(Script(kOneView));
  const auto heap = [] {
    const auto info = mallinfo2();
    return info.uordblks + info.hblkhd;
  };
  const std::size_t before = heap();
  for (int i = 0; i < 2000; ++i) {
    node_->Handle(Ready("stranger" + std::to_string(i), std::string(50'000, 'x')));
  }
  EXPECT_LT(heap(), before + 20'000'000);
  EverybodyReady();
  Run();
  EXPECT_EQ(node_->failure(), "") << "those that are needed are heard all the same";
}

TEST_F(SessionNodeTest, TheHappyPathWritesTheSessionDirectory) {
  SessionScript script = Script(kOneView);
  script.steps[2].heldout = true;
  script.steps[2].picked_cameras = {"thermal"};
  Start(script);
  EverybodyReady();
  Run();
  ASSERT_TRUE(node_->finished());
  EXPECT_EQ(node_->failure(), "");
  std::vector<SessionVerb> verbs;
  for (const SessionCommand& command : world_.commands) verbs.push_back(command.verb);
  EXPECT_THAT(verbs, ::testing::ElementsAre(SessionVerb::kReset, SessionVerb::kNextPose,
                                            SessionVerb::kSweep, SessionVerb::kCapture,
                                            SessionVerb::kSolve, SessionVerb::kEvaluate));
  const SessionCommand& capture = world_.commands[3];
  EXPECT_EQ(capture.view, "0001");
  EXPECT_EQ(capture.sweep_utime, kStart + 3 * kMicrosecondsPerSecond);
  EXPECT_GE(capture.utime, capture.sweep_utime) << "the newest sensor time that it knew";

  const Session session = OpenSession(dir_ / "session");
  EXPECT_EQ(session.rig.hash, TinyRig().hash);
  ASSERT_THAT(session.views, ::testing::ElementsAre("0001"));
  const View view = ReadView(session, "0001");
  EXPECT_TRUE(view.heldout);
  EXPECT_EQ(view.cloud.sweep_utime, capture.sweep_utime);
  EXPECT_EQ(view.images.size(), 2U);
  EXPECT_EQ(view.picks.size(), 1U);
  EXPECT_EQ(ReadCalibration(dir_ / "session/calibration.textproto").rig_hash, TinyRig().hash);
  EXPECT_EQ(ReadReport(dir_ / "session/report.json").method, "paper");
  ASSERT_FALSE(progress_.empty());
  EXPECT_EQ(progress_.front().steps, 6);
  EXPECT_EQ(progress_.back().step, 6);
  EXPECT_EQ(progress_.back().fraction, 1);
}

// The folder's name may have served before: what stands there is not this session's.
TEST_F(SessionNodeTest, ResultsOfAnEarlierRunAreSetAsideOnceItBegins) {
  const auto calibration = dir_ / "session/calibration.textproto";
  WriteFileAtomically(calibration, "an earlier one");
  world_.solved = false;
  Start(Script(kOneView));
  AdvanceTo(0, node_.get());
  EXPECT_TRUE(std::filesystem::exists(calibration)) << "nobody is ready yet";
  EverybodyReady();
  Run();
  EXPECT_TRUE(node_->finished());
  EXPECT_NE(node_->failure(), "");
  EXPECT_FALSE(std::filesystem::exists(calibration));
  EXPECT_EQ(ReadWholeFile(dir_ / "session/calibration.previous.textproto"), "an earlier one");
  EXPECT_EQ(ReadReport(dir_ / "session/report.json").cameras[0].calibration.status,
            SolveStatus::kNotSolved);
}

TEST_F(SessionNodeTest, WaitsUntilEverybodyIsReady) {
  Start(Script(kOneView));
  for (const Utime now : {0, 1}) {
    EXPECT_EQ(Only<RigText>(node_->Advance(now * kMicrosecondsPerSecond)).at(0).hash,
              TinyRig().hash);
  }
  EXPECT_TRUE(node_->Advance(kMicrosecondsPerSecond).empty()) << "the rig, once a second";
  for (const char* process : {"assembler", "solver", "fuser"}) node_->Handle(Ready(process));
  node_->Handle(Ready("detector", "waits for the rig (RIG)", false));
  EXPECT_TRUE(AdvanceTo(1, node_.get()).empty());
  EXPECT_THAT(node_->GetStatus().text, HasSubstr("rgbdt-detector (waits for the rig (RIG))"));
  node_->Handle(Ready("detector"));
  const auto commands = Only<SessionCommand>(AdvanceTo(1.1, node_.get()));
  ASSERT_EQ(commands.size(), 2U);
  EXPECT_EQ(commands[0].verb, SessionVerb::kReset);
  EXPECT_EQ(commands[1].verb, SessionVerb::kNextPose);
}

TEST_F(SessionNodeTest, TheDevicesOfTheRigFileAreWaitedForToo) {
  Rig rig = TinyRig();
  rig.cameras[0].device = CameraDevice();
  rig.lidar.device = HokuyoDevice();
  rig.lidar.turned_scanner->motor = DynamixelDevice();
  SessionNode node(Script(kOneView), rig, dir_ / "session", {});
  for (const char* process : {"assembler", "detector", "solver", "fuser"}) {
    node.Handle(Ready(process));
  }
  EXPECT_TRUE(AdvanceTo(1, &node).empty());
  EXPECT_THAT(node.GetStatus().text,
              AllOf(HasSubstr("rgbdt-camera-rgb (not heard)"), HasSubstr("rgbdt-lidar"),
                    HasSubstr("rgbdt-motor"), ::testing::Not(HasSubstr("thermal"))));
  for (const char* process : {"camera-rgb", "lidar", "motor"}) node.Handle(Ready(process));
  EXPECT_FALSE(AdvanceTo(2, &node).empty());
}

TEST_F(SessionNodeTest, NoAssemblerIsWaitedForWhereTheLidarGivesWholeSweeps) {
  Rig rig = TinyRig();
  rig.lidar.turned_scanner.reset();
  rig.lidar.device = VelodyneDevice();
  SessionNode node(Script(kOneView), rig, dir_ / "session", {});
  for (const char* process : {"detector", "solver", "fuser"}) node.Handle(Ready(process));
  EXPECT_TRUE(AdvanceTo(1, &node).empty());
  EXPECT_THAT(node.GetStatus().text, HasSubstr("waits for: rgbdt-lidar (not heard)"));
  node.Handle(Ready("lidar"));
  EXPECT_FALSE(Only<SessionCommand>(AdvanceTo(2, &node)).empty());
}

TEST_F(SessionNodeTest, APersonWhoCarriesTheBoardIsAskedUntilItStands) {
  int asked = 0;
  bool stands = false;
  SessionNode node(Script({Kind::kNextPose, Kind::kSweep}), TinyRig(), dir_ / "session", {}, [&] {
    ++asked;
    return stands;
  });
  AdvanceTo(0, &node);
  EXPECT_EQ(asked, 0);
  for (const char* process : {"assembler", "detector", "solver", "fuser"}) {
    node.Handle(Ready(process));
  }
  AdvanceTo(0, &node);
  EXPECT_EQ(test::Counter(node.GetStatus(), "waits for pose"), 1);
  EXPECT_TRUE(AdvanceTo(1, &node).empty());
  EXPECT_TRUE(AdvanceTo(10'000, &node).empty()) << "nobody is hurried";
  EXPECT_EQ(asked, 2);
  stands = true;
  const auto commands = Only<SessionCommand>(AdvanceTo(10'001, &node));
  ASSERT_EQ(commands.size(), 1U);
  EXPECT_EQ(commands[0].verb, SessionVerb::kSweep);
  EXPECT_TRUE(AdvanceTo(10'002, &node).empty());
  EXPECT_EQ(asked, 3);
}

// The encoder's stamps would be another time's than the lines'; a simulated rig has one clock.
TEST_F(SessionNodeTest, NoSweepOfDevicesBeginsWhileClocksDisagree) {
  Rig with_device = TinyRig();
  with_device.cameras[0].device = CameraDevice();
  Status off = Ready("solver");
  off.counters = {{"clock ahead [ms] sensor (10.0.0.2)", -200}};
  const auto sweeps = [](const Messages& messages) {
    const auto commands = Only<SessionCommand>(messages);
    return std::count_if(commands.begin(), commands.end(), [](const SessionCommand& command) {
      return command.verb == SessionVerb::kSweep;
    });
  };
  for (const Rig& rig : {with_device, TinyRig()}) {
    for (const bool mended : {true, false}) {
      const bool has_device = rig.cameras[0].device.has_value();
      SessionNode node(Script({Kind::kSweep}), rig,
                       dir_ / (std::to_string(has_device) + std::to_string(mended)), {});
      AdvanceTo(0, &node);
      for (const char* process : {"assembler", "detector", "fuser"}) node.Handle(Ready(process));
      node.Handle(Ready("camera-" + rig.cameras[0].name));
      node.Handle(off);
      EXPECT_EQ(sweeps(AdvanceTo(1, &node)), has_device ? 0 : 1);
      if (!has_device) continue;
      EXPECT_EQ(sweeps(AdvanceTo(9, &node)), 0);
      if (mended) {
        node.Handle(Ready("solver"));
        EXPECT_EQ(sweeps(AdvanceTo(13.9, &node)), 0) << "drivers have not seen it yet";
        EXPECT_EQ(sweeps(AdvanceTo(14, &node)), 1);
      } else {
        AdvanceTo(12, &node);
        EXPECT_THAT(node.failure(), HasSubstr("that of host sensor (10.0.0.2) is 200 ms behind"));
      }
    }
  }
}

TEST_F(SessionNodeTest, AViewInWhoseMidstAClockWasSetIsTakenAgain) {
  Rig rig = TinyRig();
  rig.cameras[0].device = CameraDevice();
  Status off = Ready("solver");
  off.counters = {{"clock ahead [ms] sensor (10.0.0.2)", 200}};
  for (const bool in_sweep : {true, false}) {
    SessionNode node(Script({Kind::kSweep, Kind::kCapture}), rig,
                     dir_ / (in_sweep ? "sweep" : "capture"), {});
    std::int64_t newest = 0;
    const auto asked = [&](double seconds) {
      std::vector<SessionVerb> verbs;
      for (const auto& command : Only<SessionCommand>(AdvanceTo(seconds, &node))) {
        verbs.push_back(command.verb);
        newest = command.command;
      }
      return verbs;
    };
    AdvanceTo(0, &node);
    for (const char* process : {"assembler", "detector", "fuser", "solver"}) {
      node.Handle(Ready(process));
    }
    node.Handle(Ready("camera-" + rig.cameras[0].name));
    EXPECT_THAT(asked(1), ElementsAre(SessionVerb::kReset, SessionVerb::kSweep));
    if (in_sweep) node.Handle(off);
    SessionEvent swept;
    swept.command = newest;
    swept.source = "motor";
    swept.sweep_utime = kStart;
    node.Handle(swept);
    EXPECT_EQ(asked(2).size(), in_sweep ? 0U : 1U) << "the capture";
    if (!in_sweep) node.Handle(off);
    EXPECT_THAT(asked(3), IsEmpty());
    node.Handle(Ready("solver"));
    EXPECT_THAT(asked(8), ElementsAre(SessionVerb::kSweep));
    EXPECT_EQ(node.failure(), "");
  }
}

TEST_F(SessionNodeTest, APersonWhoIsGoneEndsTheSession) {
  SessionNode node(Script({Kind::kNextPose}), TinyRig(), dir_ / "session", {},
                   []() -> bool { throw InputError("nobody can press Enter"); });
  for (const char* process : {"assembler", "detector", "solver", "fuser"}) {
    node.Handle(Ready(process));
  }
  AdvanceTo(0, &node);
  AdvanceTo(1, &node);
  EXPECT_TRUE(node.finished());
  EXPECT_THAT(node.failure(), AllOf(HasSubstr("next pose"), HasSubstr("nobody can press Enter")));
}

TEST_F(SessionNodeTest, ABoardThatNobodyCarriesIsNamedWithWhatToDo) {
  world_.silent_at = SessionVerb::kNextPose;
  Start(Script(kOneView));
  EverybodyReady();
  Run();
  EXPECT_THAT(node_->failure(), AllOf(HasSubstr("next pose"), HasSubstr("--by-hand")));
}

TEST_F(SessionNodeTest, NobodyThereIsNamedAfterHalfAMinute) {
  Start(Script(kOneView));
  node_->Handle(Ready("assembler"));
  node_->Handle(Ready("solver", "waits for the rig (RIG)", false));
  AdvanceTo(1000, node_.get());  // the clock's zero is anywhere
  AdvanceTo(1029, node_.get());
  EXPECT_FALSE(node_->finished());
  AdvanceTo(1031, node_.get());
  ASSERT_TRUE(node_->finished());
  EXPECT_THAT(node_->failure(), AllOf(HasSubstr("start"), HasSubstr("rgbdt-detector (not heard)"),
                                      HasSubstr("rgbdt-solver (waits for the rig (RIG))"),
                                      ::testing::Not(HasSubstr("assembler"))));
}

TEST_F(SessionNodeTest, ATimeOutNamesWhoDidNotAnswerAndWhatItSaid) {
  world_.silent_at = SessionVerb::kCapture;
  Start(Script(kOneView));
  EverybodyReady();
  Status status = Ready("detector", "view 0001 waits for an image of camera thermal");
  status.last_problem = "THERMAL_IMAGE: width is 3";
  meanwhile_ = [&] { node_->Handle(status); };
  Run();
  EXPECT_THAT(node_->failure(),
              AllOf(HasSubstr("step 3 of 6"), HasSubstr("capture"), HasSubstr("view 0001"),
                    HasSubstr("no answer in 10 s"), HasSubstr("rgbdt-detector says"),
                    HasSubstr("waits for an image of camera thermal"),
                    HasSubstr("THERMAL_IMAGE: width is 3")));
}

TEST_F(SessionNodeTest, ATimeOutNamesWhoIsNotThereAnyMore) {
  world_.silent_at = SessionVerb::kCapture;
  Start(Script(kOneView));
  EverybodyReady();
  Run();
  EXPECT_THAT(
      node_->failure(),
      AllOf(HasSubstr("no answer in 10 s"), HasSubstr("rgbdt-detector has not been heard for 1"),
            HasSubstr("is it running, or at work? It said: fine"), HasSubstr("silent"),
            HasSubstr("rgbdt-solver for 1"), HasSubstr("rgbdt-assembler for 1")));
}

TEST_F(SessionNodeTest, ASilentRigIsNamed) {
  world_.silent_at = SessionVerb::kSweep;
  Start(Script(kOneView));
  EverybodyReady();
  Run();
  EXPECT_THAT(node_->failure(), AllOf(HasSubstr("sweep"), HasSubstr("rgbdt-simulator")));
}

TEST_F(SessionNodeTest, ItsOwnMissingPartsAreNamed) {
  world_.images = false;  // the detector heard them, this process did not
  Start(Script(kOneView));
  EverybodyReady();
  Run();
  EXPECT_THAT(node_->failure(),
              HasSubstr("this process still lacks an image of camera rgb, an image of camera"));
}

TEST_F(SessionNodeTest, AFailedEventEndsTheSessionWithItsReason) {
  for (const SessionVerb verb :
       {SessionVerb::kNextPose, SessionVerb::kCapture, SessionVerb::kSolve}) {
    std::filesystem::remove_all(dir_ / "session");
    world_ = World();
    world_.failing_at = verb;
    Start(Script(kOneView));
    EverybodyReady();
    Run();
    ASSERT_TRUE(node_->finished());
    EXPECT_THAT(node_->failure(), HasSubstr("the motor is stuck"));
    EXPECT_EQ(world_.commands.back().verb, verb) << "nothing more is asked for";
    EXPECT_TRUE(Only<SessionCommand>(AdvanceTo(70, node_.get())).empty());
  }
}

TEST_F(SessionNodeTest, AnswersToOtherCommandsDoNotCount) {
  Start(Script(kOneView));
  EverybodyReady();
  auto commands = Only<SessionCommand>(AdvanceTo(0, node_.get()));
  SessionEvent stray = world_.Event(commands.back(), "simulator");
  stray.command += 100;
  node_->Handle(stray);
  EXPECT_TRUE(AdvanceTo(0.1, node_.get()).empty());
  stray.command -= 100;
  stray.kind = EventKind::kProgress;
  stray.fraction = 0.5;
  node_->Handle(stray);
  EXPECT_TRUE(AdvanceTo(0.2, node_.get()).empty());
  EXPECT_EQ(progress_.back().fraction, 0.5);
  stray.kind = EventKind::kDone;
  node_->Handle(stray);
  EXPECT_EQ(Only<SessionCommand>(AdvanceTo(0.3, node_.get())).size(), 1U);
}

// A busy machine: a sweep that takes three times its time, and tells how far it is.
TEST_F(SessionNodeTest, ProgressRenewsTheTimeOutAndSilenceAfterItDoesNot) {
  for (const bool ends : {true, false}) {
    std::filesystem::remove_all(dir_ / "session");
    world_ = World();
    Start(Script({Kind::kSweep, Kind::kCapture}));
    EverybodyReady();
    const SessionCommand sweep = Only<SessionCommand>(AdvanceTo(0, node_.get())).back();
    ASSERT_EQ(sweep.verb, SessionVerb::kSweep);
    SessionEvent progress = world_.Event(sweep, "simulator");
    progress.kind = EventKind::kProgress;
    for (int i = 1; i <= 5; ++i) {
      AdvanceTo(6 * i - 0.1, node_.get());
      progress.fraction = 0.1 * i;
      node_->Handle(progress);
    }
    if (ends) {
      test::HandleAll(node_.get(), world_.Answer(sweep));
      AdvanceTo(31, node_.get());
      AdvanceTo(39, node_.get());
      EXPECT_FALSE(node_->finished()) << "the capture has its own time";
      continue;
    }
    for (double t = 30; t < 39; t += 3) {
      node_->Handle(progress);  // nothing new
      AdvanceTo(t, node_.get());
      EXPECT_FALSE(node_->finished()) << t << ": " << node_->failure();
    }
    node_->Handle(progress);
    AdvanceTo(41, node_.get());
    EXPECT_THAT(node_->failure(),
                AllOf(HasSubstr("sweep"), HasSubstr("no answer and no progress in 10 s"),
                      HasSubstr("simulator was at 50%")));
  }
}

TEST_F(SessionNodeTest, AStepThatCreepsOnForeverEnds) {
  Start(Script({Kind::kSweep}));
  EverybodyReady();
  const SessionCommand sweep = Only<SessionCommand>(AdvanceTo(0, node_.get())).back();
  SessionEvent progress = world_.Event(sweep, "motor");
  progress.kind = EventKind::kProgress;
  double t = 0;
  for (; t < 1000 && !node_->finished(); t += 5) {
    progress.fraction = t / 1000;
    node_->Handle(progress);
    AdvanceTo(t, node_.get());
  }
  EXPECT_GT(t, 10 * StepTimeout::kMostTimes);
  const std::string percent = std::to_string(std::lround(100 * progress.fraction));
  EXPECT_THAT(node_->failure(),
              AllOf(HasSubstr("no answer in 100 s, though motor was at " + percent + "%"),
                    HasSubstr("timeout_s")));
}

TEST_F(SessionNodeTest, AWaitMayBeLongerThanTheTimeOut) {
  SessionScript script = Script({Kind::kWait});
  script.steps[0].wait_s = 25;
  Start(script);
  EverybodyReady();
  AdvanceTo(0, node_.get());
  AdvanceTo(24, node_.get());
  EXPECT_FALSE(node_->finished());
  AdvanceTo(25.5, node_.get());
  EXPECT_TRUE(node_->finished());
  EXPECT_EQ(node_->failure(), "");
}

TEST_F(SessionNodeTest, SaveWithoutAReportFails) {
  Start(Script({Kind::kSave}));
  EverybodyReady();
  Run();
  EXPECT_THAT(node_->failure(), HasSubstr("put solve before save"));
}

TEST_F(SessionNodeTest, TooFewViewsForACalibrationFailWithTheReason) {
  world_.solved = false;
  Start(Script(kOneView));
  EverybodyReady();
  Run();
  EXPECT_THAT(node_->failure(),
              AllOf(HasSubstr("save"), HasSubstr("camera rgb: not calibrated: 2 usable views")));
  EXPECT_TRUE(std::filesystem::exists(dir_ / "session/report.json"));
  EXPECT_FALSE(std::filesystem::exists(dir_ / "session/calibration.textproto"));
}

TEST_F(SessionNodeTest, AReportWithoutACapturedViewIsNotSaved) {
  world_.forgotten = "0001";
  Start(Script(kOneView));
  EverybodyReady();
  Run();
  EXPECT_THAT(node_->failure(), AllOf(HasSubstr("solve"), HasSubstr("lacks view 0001"),
                                      Not(HasSubstr("rgbdt calibrate"))))
      << "one view is too few";
  EXPECT_FALSE(std::filesystem::exists(dir_ / "session/calibration.textproto"));
  const auto asked = std::count_if(
      world_.commands.begin(), world_.commands.end(),
      [](const SessionCommand& command) { return command.verb == SessionVerb::kSolve; });
  EXPECT_EQ(asked, 1 + SolverViews::kMaxTries);
}

TEST_F(SessionNodeTest, AViewAfterTheLastSolveIsNotLeftOutUnsaid) {
  Start(Script({Kind::kNextPose, Kind::kSweep, Kind::kCapture, Kind::kSolve, Kind::kNextPose,
                Kind::kSweep, Kind::kCapture, Kind::kSave}));
  EverybodyReady();
  Run();
  EXPECT_THAT(node_->failure(), AllOf(HasSubstr("save"), HasSubstr("lacks view 0002"),
                                      HasSubstr("put solve after the last capture")));
}

TEST_F(SessionNodeTest, AScriptDoesNotWaitForRoomForever) {
  Start(Script(kOneView));
  EverybodyReady();
  test::WriteQuickly(dir_ / "file", "");
  std::filesystem::create_directories(dir_ / "session");
  std::filesystem::create_symlink(dir_ / "file", dir_ / "session/views");
  Run();
  EXPECT_THAT(node_->failure(), AllOf(HasSubstr("sweep"), HasSubstr("not ready after 10 s"),
                                      HasSubstr((dir_ / "session/views").string())));
}

TEST_F(SessionNodeTest, ADirectoryThatCannotBeWrittenEndsTheSession) {
  Start(Script(kOneView));
  EverybodyReady();
  test::WriteQuickly(dir_ / "session", "");
  Run();
  EXPECT_THAT(node_->failure(), AllOf(HasSubstr("start"), HasSubstr((dir_ / "session").string())));
  EXPECT_TRUE(world_.commands.empty());
}

TEST_F(SessionNodeTest, ViewsOfAnEarlierSessionStayUntouched) {
  std::filesystem::create_directories(dir_ / "session/views/0001");
  EXPECT_THAT(ErrorOf([&] { Start(Script(kOneView)); }),
              AllOf(HasSubstr("session/views"), HasSubstr("earlier session")));
}

TEST_F(SessionNodeTest, WrongImagesAndStrangersAreRefused) {
  Start(Script(kOneView));
  Image image = Blank(TinyRig().cameras[0], kStart);
  image.pixels = cv::Mat(4, 4, CV_8UC1, cv::Scalar(0));
  EXPECT_THAT(ErrorOf([&] { node_->Handle(image); }), HasSubstr("4x4"));
  image = Blank(TinyRig().cameras[0], kStart);
  image.camera = "front";
  EXPECT_THAT(ErrorOf([&] { node_->Handle(image); }), HasSubstr("front"));
  CornerSelection picks;
  picks.camera = "front";
  EXPECT_THAT(ErrorOf([&] { node_->Handle(picks); }), HasSubstr("front"));
  EXPECT_THAT(ErrorOf([&] { Start(SessionScript()); }), HasSubstr("no steps"));
}

}  // namespace
}  // namespace rgbdt
