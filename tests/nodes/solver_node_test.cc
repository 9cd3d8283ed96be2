#include "services/nodes/solver_node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calib/files/schema/calibration_file.h"
#include "calib/files/schema/report_file.h"
#include "tests/nodes/nodes_testing.h"
#include "tests/unit/files/test_data.h"
#include "tests/unit/solve/board_world.h"
#include "tests/unit/solve/solve_world.h"

namespace rgbdt {
namespace {

using test::ErrorOf;
using test::Only;
using ::testing::HasSubstr;

const BoardWorld& World() {
  static const BoardWorld world = MakeBoardWorld(6);
  return world;
}

Rig MakeRig(double guess_off = 0.02) {
  Rig rig = simulate::Simulator(test::TinyOptions()).rig();
  CameraSpec camera = World().spec;
  camera.camera_from_lidar_guess = GuessOff(World().camera_from_lidar, guess_off, 0.03, 5);
  rig.cameras = {camera};
  return ParseRig(PrintRig(rig), "test rig");
}

SessionCommand Command(SessionVerb verb) {
  SessionCommand command;
  command.command = 40;
  command.verb = verb;
  command.utime = 5000;
  return command;
}

std::string CalibrationOf(const SolverNode& node) {
  return node.report() ? PrintCalibration(node.report()->ToCalibration()) : "";
}

class SolverNodeTest : public ::testing::Test {
 protected:
  SolverNodeTest() { node_.Handle(test::TextOf(MakeRig())); }
  Messages FeedWorld() {
    return test::HandleAll(&node_, Messages(World().views.begin(), World().views.end()));
  }
  static CalibrateOptions ByPaper() {
    CalibrateOptions options;
    options.method = kPaperMethod;
    return options;
  }
  SolverNode node_{ByPaper()};
};

TEST(SolverNodeRigTest, BeforeTheRigNothingIsTaken) {
  SolverNode node;
  EXPECT_FALSE(node.GetStatus().ready);
  EXPECT_THAT(ErrorOf([&] { node.Handle(World().views[0]); }), HasSubstr("no rig heard yet"));
  CalibrateOptions options;
  options.method = "magic";
  EXPECT_THAT(ErrorOf([&] { SolverNode bad(options); }), HasSubstr("magic"));
}

TEST_F(SolverNodeTest, SolvesOnceForEachView) {
  std::size_t calibrations = 0;
  for (const ViewDetection& detection : World().views) {
    const auto out = Only<CalibrationMessage>(node_.Handle(detection));
    calibrations += out.size();
    EXPECT_LE(out.size(), 1U) << "one solve a view";
    for (const CalibrationMessage& message : out) {
      EXPECT_EQ(message.rig_hash, MakeRig().hash);
      EXPECT_EQ(message.method, "paper");
    }
  }
  EXPECT_EQ(calibrations, 3U) << "from the third view on that is not held out";
  EXPECT_THAT(node_.GetStatus().text, HasSubstr("calibrated from 6 views"));
  ASSERT_TRUE(node_.report().has_value());
  EXPECT_EQ(node_.report()->cameras[0].used.size(), 4U);
  EXPECT_EQ(node_.report()->cameras[0].heldout.size(), 2U);
  // An ideal world but for its pixel grid; the unit tests of solve/ hold the accuracy.
  EXPECT_THAT(node_.report()->cameras[0].calibration.camera_from_lidar,
              Rigid3Near(World().camera_from_lidar, 0.01, 0.03));
}

TEST_F(SolverNodeTest, TheOrderOfViewsDoesNotMatterAndRepeatsReplace) {
  FeedWorld();
  const std::string expected = CalibrationOf(node_);
  SolverNode backwards(ByPaper());
  backwards.Handle(test::TextOf(MakeRig()));
  test::HandleAll(&backwards, Messages(World().views.rbegin(), World().views.rend()));
  EXPECT_EQ(CalibrationOf(backwards), expected);
  FeedWorld();
  EXPECT_EQ(CalibrationOf(node_), expected);
  EXPECT_EQ(test::Counter(node_.GetStatus(), "views"), 6);
  // Another detection of a view takes the place of the first.
  ViewDetection hidden = World().views[0];
  hidden.images[0].why_not = "somebody stood before it";
  node_.Handle(hidden);
  EXPECT_EQ(test::Counter(node_.GetStatus(), "views"), 6);
  EXPECT_EQ(node_.report()->cameras[0].used.size(), 3U);
  EXPECT_EQ(node_.report()->cameras[0].rejected.at(0).why, "somebody stood before it");
}

TEST_F(SolverNodeTest, SolveAndEvaluateAreAnsweredWithReportAndEvent) {
  FeedWorld();
  for (const SessionVerb verb : {SessionVerb::kSolve, SessionVerb::kEvaluate}) {
    const Messages out = node_.Handle(Command(verb));
    EXPECT_EQ(Only<CalibrationMessage>(out).size(), 1U);
    ASSERT_EQ(Only<ReportText>(out).size(), 1U);
    const Report report = ReportFromJson(Only<ReportText>(out)[0].json);
    EXPECT_EQ(PrintCalibration(report.ToCalibration()), CalibrationOf(node_))
        << "what the session saves is what the solver has, bit for bit";
    ASSERT_TRUE(std::holds_alternative<SessionEvent>(out.back())) << "the event comes last";
    const auto& event = std::get<SessionEvent>(out.back());
    EXPECT_EQ(event.kind, EventKind::kDone);
    EXPECT_EQ(event.command, 40);
    EXPECT_THAT(event.text, HasSubstr(verb == SessionVerb::kSolve ? " px" : "held-out"));
  }
}

TEST_F(SolverNodeTest, WithoutViewsSolvingFailsWithTheReason) {
  for (const SessionVerb verb : {SessionVerb::kSolve, SessionVerb::kEvaluate}) {
    const auto events = Only<SessionEvent>(node_.Handle(Command(verb)));
    ASSERT_EQ(events.size(), 1U);
    EXPECT_EQ(events[0].kind, EventKind::kFailed);
    EXPECT_THAT(events[0].text, HasSubstr("no view yet"));
  }
}

TEST_F(SolverNodeTest, RepeatsTheCalibration) {
  EXPECT_TRUE(node_.Advance(0).empty());
  const Messages last = node_.Handle(World().views[0]);
  FeedWorld();
  EXPECT_TRUE(node_.Advance(kMicrosecondsPerSecond - 1).empty());
  const auto repeated = Only<CalibrationMessage>(node_.Advance(kMicrosecondsPerSecond));
  ASSERT_EQ(repeated.size(), 1U);
  EXPECT_EQ(Encode(repeated[0]),
            Encode(Only<CalibrationMessage>(node_.Handle(Command(SessionVerb::kSolve)))[0]));
}

TEST_F(SolverNodeTest, ResetAndAnotherRigForgetAll) {
  FeedWorld();
  node_.Handle(test::TextOf(MakeRig()));  // the same rig again changes nothing
  EXPECT_TRUE(node_.report().has_value());
  node_.Handle(Command(SessionVerb::kReset));
  EXPECT_FALSE(node_.report().has_value());
  EXPECT_TRUE(node_.Advance(0).empty());
  EXPECT_EQ(node_.GetStatus().text, "waits for views");
  FeedWorld();
  node_.Handle(test::TextOf(MakeRig(0.03)));
  EXPECT_FALSE(node_.report().has_value());
}

TEST_F(SolverNodeTest, ViewsThatAPersonLeavesOutHaveNoPartUntilTheyAreTakenBack) {
  FeedWorld();
  const std::string with_all = CalibrationOf(node_);
  LeftOutViews left_out;
  left_out.views = {World().views[0].view};
  const Messages out = node_.Handle(left_out);
  EXPECT_EQ(Only<CalibrationMessage>(out).size(), 1U);
  ASSERT_EQ(Only<ReportText>(out).size(), 1U);
  const Report report = ReportFromJson(Only<ReportText>(out)[0].json);
  EXPECT_EQ(report.cameras[0].used.size(), 3U);
  EXPECT_THAT(report.cameras[0].warnings, ::testing::Contains(HasSubstr(left_out.views[0])));
  EXPECT_NE(CalibrationOf(node_), with_all);
  node_.Handle(Command(SessionVerb::kSolve));
  EXPECT_EQ(node_.report()->cameras[0].used.size(), 3U) << "it stays out";
  node_.Handle(LeftOutViews());
  EXPECT_EQ(CalibrationOf(node_), with_all);
}

TEST_F(SolverNodeTest, WhereAllViewsWouldBeLeftOutNothingChanges) {
  FeedWorld();
  const std::string before = CalibrationOf(node_);
  LeftOutViews all;
  for (const ViewDetection& view : World().views) all.views.push_back(view.view);
  EXPECT_THAT(ErrorOf([&] { node_.Handle(all); }), HasSubstr("all views are left out"));
  node_.Handle(Command(SessionVerb::kSolve));
  EXPECT_EQ(CalibrationOf(node_), before);
}

TEST_F(SolverNodeTest, ADetectionOfAStrangersCameraIsRefused) {
  ViewDetection stranger = World().views[0];
  stranger.images[0].camera = "front";
  EXPECT_THAT(ErrorOf([&] { node_.Handle(stranger); }), HasSubstr("front"));
  EXPECT_EQ(test::Counter(node_.GetStatus(), "views"), 0);
}

// All cameras of a view come in one message, and are solved for at once.
TEST(SolverNodeViewTest, AViewIsOneMessageAndOneSolveForAllCameras) {
  const SolveWorld world;
  Rig rig = simulate::Simulator(test::TinyOptions()).rig();
  rig.cameras = world.rig.cameras;
  rig.cameras[1].format = PixelFormat::kMono16;
  rig.target = world.rig.target;
  rig = ParseRig(PrintRig(rig), "test rig");
  SolverNode node;
  node.Handle(test::TextOf(rig));
  std::vector<ViewDetection> detections = world.detections;
  ImageDetection& failed = detections[4].images[1];
  failed.edges.reset();
  failed.why_not = "no checkerboard";
  Messages last;
  for (const ViewDetection& detection : detections) {
    last = node.Handle(detection);
    EXPECT_LE(last.size(), 2U);
  }
  const auto calibrations = Only<CalibrationMessage>(last);
  ASSERT_EQ(calibrations.size(), 2U);
  EXPECT_EQ(calibrations[0].calibration.camera, "rgb");
  EXPECT_EQ(calibrations[1].calibration.camera, "thermal");
  // A view of which one image failed serves the other camera.
  ASSERT_TRUE(node.report());
  EXPECT_EQ(node.report()->cameras[0].used.size(), 10U);
  EXPECT_EQ(node.report()->cameras[1].used.size(), 9U);
  EXPECT_EQ(node.report()->cameras[1].rejected.at(0).why, "no checkerboard");
  EXPECT_EQ(node.report()->detections.at(4).images.at(1).why_not, "no checkerboard");
  EXPECT_EQ(node.report()->detections.at(4).images.at(0).why_not, "");
  EXPECT_EQ(node.report()->detections.at(4).cloud_why_not, "");
}

}  // namespace
}  // namespace rgbdt
