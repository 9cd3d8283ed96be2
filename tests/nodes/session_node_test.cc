#include "services/nodes/session_node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calib/files/calibration_file.h"
#include "calib/files/report_file.h"
#include "calib/files/session_dir.h"
#include "tests/nodes/nodes_testing.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using test::ErrorOf;
using test::Only;
using ::testing::AllOf;
using ::testing::HasSubstr;
using Kind = SessionStep::Kind;

constexpr Utime kNow = 1'500'000'000'000'000;

const Rig& TinyRig() {
  static const Rig rig = test::RigOf(simulate::Simulator(test::TinyOptions()));
  return rig;
}

SessionStep Step(Kind kind) {
  SessionStep step;
  step.kind = kind;
  step.timeout_s = 10;
  return step;
}

SessionScript Script(const std::vector<Kind>& kinds) {
  SessionScript script;
  for (const Kind kind : kinds) script.steps.push_back(Step(kind));
  return script;
}

const std::vector<Kind> kOneView = {Kind::kNextPose, Kind::kSweep,    Kind::kCapture,
                                    Kind::kSolve,    Kind::kEvaluate, Kind::kSave};

Status Ready(const std::string& process, const std::string& text = "fine", bool ready = true) {
  Status status;
  status.process = process;
  status.ready = ready;
  status.text = text;
  return status;
}

Image Blank(const CameraSpec& camera, Utime utime) {
  Image image;
  image.camera = camera.name;
  image.utime = utime;
  image.format = camera.format;
  image.pixels = cv::Mat(camera.height, camera.width,
                         camera.kind == CameraKind::kThermal ? CV_16UC1 : CV_8UC1, cv::Scalar(90));
  return image;
}

// Everybody else, in one: answers each command as its verb asks, unless told otherwise.
class World {
 public:
  Messages Answer(const SessionCommand& command) {
    commands.push_back(command);
    if (command.verb == silent_at) return {};
    now += kMicrosecondsPerSecond;
    switch (command.verb) {
      case SessionVerb::kReset:
        return {};
      case SessionVerb::kNextPose:
        return {Event(command, "simulator")};
      case SessionVerb::kSweep:
        return Sweep(command);
      case SessionVerb::kCapture:
        return Capture(command);
      case SessionVerb::kSolve:
      case SessionVerb::kEvaluate:
        break;
    }
    Report report;
    for (const CameraSpec& camera : TinyRig().cameras) {
      report.cameras.emplace_back();
      report.cameras.back().calibration.camera = camera.name;
      report.cameras.back().calibration.converged = solved;
      report.cameras.back().calibration.status = solved ? "converged" : "2 usable views";
      if (solved) report.cameras.back().distance_transform_px.train = 1;
    }
    report.method = "paper";
    report.rig_hash = TinyRig().hash;
    return {ReportText{0, now, ReportToJson(report)}, Event(command, "solver")};
  }

  SessionEvent Event(const SessionCommand& command, const std::string& source) const {
    SessionEvent event;
    event.command = command.command;
    event.source = source;
    event.utime = now;
    event.text = "done by " + source;
    if (command.verb == failing_at) {
      event.kind = EventKind::kFailed;
      event.text = "the motor is stuck";
    }
    return event;
  }

  Utime now = kNow;
  std::optional<SessionVerb> silent_at, failing_at;
  bool images = true;
  bool solved = true;
  std::vector<SessionCommand> commands;

 private:
  Messages Sweep(const SessionCommand& command) const {
    CloudChunk chunk;
    chunk.cloud.sweep_utime = now;
    chunk.cloud.lines = 1;
    chunk.cloud.beams = 2;
    chunk.cloud.points = {{1, 2, 3}, {4, 5, 6}};
    chunk.cloud.utime = {now, now + 1};
    chunk.sweep_end = true;
    chunk.sweep_lines = 1;
    SessionEvent done = Event(command, "simulator");
    done.sweep_utime = now;
    return {chunk, done};
  }
  Messages Capture(const SessionCommand& command) const {
    Messages out;
    for (const CameraSpec& camera : TinyRig().cameras) {
      if (images) out.push_back(Blank(camera, now));
    }
    for (const std::string& camera : command.picked_cameras) {
      CornerSelection picks;
      picks.camera = camera;
      picks.utime = picks.image_utime = now;
      picks.corners = {{{1, 1}, {9, 1}, {9, 9}, {1, 9}}};
      out.push_back(picks);
    }
    out.push_back(Event(command, "simulator"));  // its images are taken: not what is waited for
    out.push_back(Event(command, "detector"));
    return out;
  }
};

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
      for (const SessionCommand& command : Only<SessionCommand>(node_->Advance(t))) {
        test::HandleAll(node_.get(), world_.Answer(command));
      }
    }
  }

  test::TempDir dir_;
  World world_;
  std::vector<SessionProgress> progress_;
  std::unique_ptr<SessionNode> node_;
};

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
  EXPECT_EQ(capture.sweep_utime, kNow + 3 * kMicrosecondsPerSecond);
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

TEST_F(SessionNodeTest, WaitsUntilEverybodyIsReady) {
  Start(Script(kOneView));
  EXPECT_EQ(Only<RigText>(node_->Republish()).at(0).hash, TinyRig().hash);
  for (const char* process : {"assembler", "solver", "fuser"}) node_->Handle(Ready(process));
  node_->Handle(Ready("detector", "waits for the rig (RIG)", false));
  EXPECT_TRUE(node_->Advance(1).empty());
  EXPECT_THAT(node_->GetStatus().text, HasSubstr("rgbdt-detector (waits for the rig (RIG))"));
  node_->Handle(Ready("detector"));
  const auto commands = Only<SessionCommand>(node_->Advance(1.1));
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
  EXPECT_TRUE(node.Advance(1).empty());
  EXPECT_THAT(node.GetStatus().text,
              AllOf(HasSubstr("rgbdt-camera-rgb (not heard)"), HasSubstr("rgbdt-lidar"),
                    HasSubstr("rgbdt-motor"), ::testing::Not(HasSubstr("thermal"))));
  for (const char* process : {"camera-rgb", "lidar", "motor"}) node.Handle(Ready(process));
  EXPECT_FALSE(node.Advance(2).empty());
}

TEST_F(SessionNodeTest, APersonWhoCarriesTheBoardSaysSo) {
  Start(Script({Kind::kNextPose, Kind::kSweep}));
  EXPECT_FALSE(node_->WaitsForPose());
  EverybodyReady();
  node_->Advance(0);
  EXPECT_TRUE(node_->WaitsForPose());
  EXPECT_TRUE(node_->Advance(1).empty());
  node_->PoseIsSet();
  EXPECT_FALSE(node_->WaitsForPose());
  const auto commands = Only<SessionCommand>(node_->Advance(2));
  ASSERT_EQ(commands.size(), 1U);
  EXPECT_EQ(commands[0].verb, SessionVerb::kSweep);
  node_->PoseIsSet();  // too late, of no effect
  EXPECT_TRUE(node_->Advance(3).empty());
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
  node_->Advance(29);
  EXPECT_FALSE(node_->finished());
  node_->Advance(31);
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
  node_->Handle(status);
  Run();
  EXPECT_THAT(node_->failure(),
              AllOf(HasSubstr("step 3 of 6"), HasSubstr("capture"), HasSubstr("view 0001"),
                    HasSubstr("no answer in 10 s"), HasSubstr("rgbdt-detector says"),
                    HasSubstr("waits for an image of camera thermal"),
                    HasSubstr("THERMAL_IMAGE: width is 3")));
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
    EXPECT_TRUE(node_->Advance(70).empty());
  }
}

TEST_F(SessionNodeTest, AnswersToOtherCommandsDoNotCount) {
  Start(Script(kOneView));
  EverybodyReady();
  auto commands = Only<SessionCommand>(node_->Advance(0));
  SessionEvent stray = world_.Event(commands.back(), "simulator");
  stray.command += 100;
  node_->Handle(stray);
  EXPECT_TRUE(node_->Advance(0.1).empty());
  stray.command -= 100;
  stray.kind = EventKind::kProgress;
  stray.fraction = 0.5;
  node_->Handle(stray);
  EXPECT_TRUE(node_->Advance(0.2).empty());
  EXPECT_EQ(progress_.back().fraction, 0.5);
  stray.kind = EventKind::kDone;
  node_->Handle(stray);
  EXPECT_EQ(Only<SessionCommand>(node_->Advance(0.3)).size(), 1U);
}

TEST_F(SessionNodeTest, AWaitMayBeLongerThanTheTimeOut) {
  SessionScript script = Script({Kind::kWait});
  script.steps[0].wait_s = 25;
  Start(script);
  EverybodyReady();
  node_->Advance(0);
  node_->Advance(24);
  EXPECT_FALSE(node_->finished());
  node_->Advance(25.5);
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
  EXPECT_THAT(node_->failure(), AllOf(HasSubstr("save"), HasSubstr("camera rgb: 2 usable views")));
  EXPECT_TRUE(std::filesystem::exists(dir_ / "session/report.json"));
  EXPECT_FALSE(std::filesystem::exists(dir_ / "session/calibration.textproto"));
}

TEST_F(SessionNodeTest, AViewThatCannotBeWrittenEndsTheSession) {
  Start(Script(kOneView));
  EverybodyReady();
  test::WriteQuickly(dir_ / "file", "");
  std::filesystem::create_directories(dir_ / "session");
  std::filesystem::create_symlink(dir_ / "file", dir_ / "session/views");
  Run();
  EXPECT_THAT(node_->failure(), HasSubstr((dir_ / "session/views").string()));
}

TEST_F(SessionNodeTest, ViewsOfAnEarlierSessionStayUntouched) {
  std::filesystem::create_directories(dir_ / "session/views/0001");
  EXPECT_THAT(ErrorOf([&] { Start(Script(kOneView)); }),
              AllOf(HasSubstr("session/views"), HasSubstr("earlier session")));
}

TEST_F(SessionNodeTest, WrongImagesAndStrangersAreRefused) {
  Start(Script(kOneView));
  Image image = Blank(TinyRig().cameras[0], kNow);
  image.pixels = cv::Mat(4, 4, CV_8UC1, cv::Scalar(0));
  EXPECT_THAT(ErrorOf([&] { node_->Handle(image); }), HasSubstr("4x4"));
  image = Blank(TinyRig().cameras[0], kNow);
  image.camera = "front";
  EXPECT_THAT(ErrorOf([&] { node_->Handle(image); }), HasSubstr("front"));
  CornerSelection picks;
  picks.camera = "front";
  EXPECT_THAT(ErrorOf([&] { node_->Handle(picks); }), HasSubstr("front"));
  EXPECT_THAT(ErrorOf([&] { Start(SessionScript()); }), HasSubstr("no steps"));
}

}  // namespace
}  // namespace rgbdt
