// What node.h promises: a message that a node refuses leaves it as if it had never come.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "calib/files/schema/report_file.h"
#include "calib/files/session/session_dir.h"
#include "services/nodes/assembler_node.h"
#include "services/nodes/detector_node.h"
#include "services/nodes/fuser_node.h"
#include "services/nodes/mapper_node.h"
#include "services/nodes/session_node.h"
#include "services/nodes/solver_node.h"
#include "services/simulator/simulator_node.h"
#include "tests/nodes/session_world.h"
#include "tests/nodes/twins.h"
#include "tests/numbers.h"
#include "tests/unit/files/test_data.h"
#include "tests/unit/solve/board_world.h"

namespace rgbdt {
namespace {

using test::Blank;
using test::kStart;
using test::TinyRig;
using test::Twins;
using ::testing::Each;
using ::testing::Gt;

RigText Garbage() { return {0, "another hash", "cameras { nonsense }"}; }

Image WrongSize() {
  Image image = Blank(TinyRig().cameras[0], kStart);
  image.pixels = cv::Mat(4, 4, CV_8UC1, cv::Scalar(0));
  return image;
}

Image OfAStranger() {
  Image image = Blank(TinyRig().cameras[0], kStart);
  image.camera = "front";
  return image;
}

CornerSelection PicksOf(const std::string& camera, Utime utime) {
  CornerSelection picks;
  picks.camera = camera;
  picks.utime = picks.image_utime = utime;
  picks.corners = {{{1, 1}, {9, 1}, {9, 9}, {1, 9}}};
  return picks;
}

CloudChunk ChunkOf(Utime sweep, int line, int beams, bool end) {
  CloudChunk chunk;
  chunk.cloud.sweep_utime = sweep;
  chunk.cloud.first_line = line;
  chunk.cloud.lines = 1;
  chunk.cloud.beams = beams;
  for (int i = 0; i < beams; ++i) {
    chunk.cloud.points.emplace_back(4, 0.01F * static_cast<float>(i), 0.01F * line);
    chunk.cloud.utime.push_back(sweep + line * kSecond / 20 + i);
  }
  chunk.cloud.intensity.assign(chunk.cloud.points.size(), 0.5F);
  chunk.sweep_end = end;
  chunk.sweep_lines = end ? line + 1 : 0;
  return chunk;
}

SessionCommand CaptureOf(std::int64_t number, Utime sweep) {
  SessionCommand command;
  command.command = number;
  command.verb = SessionVerb::kCapture;
  command.utime = sweep + kSecond;
  command.view = "000" + std::to_string(number);
  command.sweep_utime = sweep;
  return command;
}

// Sweeps of three lines and their captures, a camera's image before, the others after.
Messages Views(int count) {
  Messages messages;
  for (int view = 1; view <= count; ++view) {
    const Utime sweep = kStart + view * 10 * kSecond;
    messages.push_back(Blank(TinyRig().cameras[0], sweep + kSecond));
    for (int line = 0; line < 3; ++line) messages.push_back(ChunkOf(sweep, line, 4, line == 2));
    messages.push_back(CaptureOf(view, sweep));
    messages.push_back(Blank(TinyRig().cameras[1], sweep + kSecond));
    messages.push_back(PicksOf("rgb", sweep + kSecond));
  }
  return messages;
}

// How long it took is the wall clock's.
void ForgetDurations(Message* message) {
  if (auto* detection = std::get_if<ViewDetection>(message)) {
    for (ImageDetection& image : detection->images) image.detect_s = 0;
    detection->cloud.detect_s = 0;
  } else if (auto* text = std::get_if<ReportText>(message)) {
    Report report = ReportFromJson(text->json, "REPORT");
    for (CameraReport& camera : report.cameras) {
      camera.detect_image_s = camera.detect_cloud_s = camera.solve_s = 0;
    }
    text->json = ReportToJson(report);
  }
}

TEST(Refusal, Assembler) {
  simulate::Simulator simulator(test::TinyOptions());
  Messages good = {test::TextOf(TinyRig())};
  std::int64_t seq = 0;
  for (int sweep = 0; sweep < 2; ++sweep) {
    const Utime start = kStart + sweep * 5 * kSecond;
    const Utime end = start + simulator.sweep_lines() * simulator.line_period();
    int line = 0;
    for (Utime t = start - 50'000; t < end + 300'000; t += 10'000) {
      good.push_back(simulator.Encoder(t, t >= start && t <= end ? start : 0));
      while (line < simulator.sweep_lines() && start + (line + 1) * simulator.line_period() <= t) {
        LineScan scan = simulator.Line(start, line++);
        scan.seq = seq++;
        good.push_back(scan);
      }
    }
  }
  LineScan early = simulator.Line(kStart, 0);
  early.utime = kStart - 20'000;
  early.seq = 1000;
  LineScan again = simulator.Line(kStart, 7);
  again.seq = 7;
  LineScan misnumbered = simulator.Line(kStart, 9);
  misnumbered.utime += 1;
  misnumbered.seq = 3;

  AssemblerNode node, twin;
  Twins twins(&node, &twin);
  twins.bad = {Garbage(), simulator.Encoder(kStart - 60'000, 0), early, again, misnumbered};
  twins.Feed(good);
  EXPECT_THAT(twins.refused, Each(Gt(10)));
  EXPECT_EQ(test::Counter(node.GetStatus(), "sweeps"), 2);
}

TEST(Refusal, Detector) {
  DetectorNode node, twin;
  Twins twins(&node, &twin, ForgetDurations);
  CloudChunk endless = ChunkOf(kStart + 10 * kSecond, 0, 4, false);
  endless.cloud.first_line = 1'000'000'000;
  twins.bad = {Garbage(), WrongSize(), OfAStranger(), PicksOf("front", kStart + 11 * kSecond),
               endless};
  twins.Feed({test::TextOf(TinyRig()), ChunkOf(kStart + 10 * kSecond, 0, 4, false)});
  twins.bad.push_back(ChunkOf(kStart + 10 * kSecond, 0, 7, false));
  twins.Feed(Views(2));
  EXPECT_THAT(twins.refused, Each(Gt(1)));
  EXPECT_EQ(test::Counter(node.GetStatus(), "views"), 2);
}

StampedPose Pose(Utime utime, double x) {
  StampedPose pose;
  pose.utime = utime;
  pose.source = "gps_ins";
  pose.map_from_lidar.translation.x() = x;
  return pose;
}

CalibrationMessage Calibrated(const std::string& camera, const std::string& rig_hash) {
  CalibrationMessage message;
  message.utime = kStart;
  message.rig_hash = rig_hash;
  message.calibration.camera = camera;
  message.calibration.camera_from_lidar = *TinyRig().cameras[0].camera_from_lidar_guess;
  message.calibration.status = SolveStatus::kConverged;
  return message;
}

TEST(Refusal, Fuser) {
  FuserNode node, twin;
  Twins twins(&node, &twin);
  twins.bad = {Garbage(), WrongSize(), OfAStranger(), Calibrated("rgb", "another rig's"),
               Calibrated("front", TinyRig().hash)};
  Messages good = {test::TextOf(TinyRig()), Calibrated("rgb", TinyRig().hash)};
  for (Message& message : Views(2)) good.push_back(std::move(message));
  // A jump is taken as it is: what follows is where it says, what was before is given up.
  const Utime later = kStart + 30 * kSecond;
  for (int i = 0; i < 3; ++i) good.push_back(Pose(later + i * 100'000, 0.1 * i));
  good.push_back(ChunkOf(later, 0, 4, false));
  for (int i = 3; i < 6; ++i) good.push_back(Pose(later + i * 100'000, 1000 + 0.1 * i));
  good.push_back(ChunkOf(later, 1, 4, true));
  twins.Feed(good);
  EXPECT_THAT(twins.refused, Each(Gt(10)));
  EXPECT_EQ(test::Counter(node.GetStatus(), "pose jumps"), 1);
}

// A jump is no bad message, so nothing is thrown: from then on the node is as one that began there.
TEST(Refusal, AJumpOfThePoseIsNotRefused) {
  FuserNode node, begun_there;
  const Utime jump = kStart + kSecond;
  for (Node* one : {static_cast<Node*>(&node), static_cast<Node*>(&begun_there)}) {
    one->Handle(test::TextOf(TinyRig()));
    one->Handle(Calibrated("rgb", TinyRig().hash));
  }
  node.Handle(Pose(kStart, 0));
  EXPECT_NO_THROW(node.Handle(Pose(jump, 1000)));
  begun_there.Handle(Pose(jump, 1000));
  for (const Message& message : Messages{Pose(jump + 100'000, 1000.1), ChunkOf(jump, 0, 4, false),
                                         ChunkOf(jump, 1, 4, true)}) {
    EXPECT_EQ(test::BytesOf(node.Handle(message)), test::BytesOf(begun_there.Handle(message)));
  }
}

RgbdtCloud Fused(float x, bool posed) {
  RgbdtCloud cloud;
  cloud.sweep_utime = kStart;
  cloud.points = {{x, 0.01F, 0.01F}, {x, 0.02F, 0.02F}};
  cloud.intensity = {0.5F, 0.5F};
  cloud.utime = {kStart, kStart + 1};
  cloud.valid = {0, 0};
  if (posed) cloud.map_from_lidar = Rigid3();
  cloud.frame_utime = kStart;
  return cloud;
}

TEST(Refusal, Mapper) {
  MapperNode node{VoxelMapOptions()}, twin{VoxelMapOptions()};
  Twins twins(&node, &twin);
  RgbdtCloud uneven = Fused(9, true);  // with the first pose the map would begin anew
  uneven.utime.pop_back();
  twins.bad = {uneven};
  twins.Feed({Fused(1, false), Fused(2, false)});
  EXPECT_EQ(node.map().size(), 2U);
  twins.Feed({Fused(3, true)});
  twins.bad.push_back(Fused(8, false));
  twins.Feed({Fused(4, true)});
  EXPECT_THAT(twins.refused, Each(Gt(1)));
  EXPECT_EQ(node.map().points(), twin.map().points());
  EXPECT_EQ(node.map().Cloud().points, twin.map().Cloud().points);
}

TEST(Refusal, Solver) {
  const BoardWorld world = MakeBoardWorld(6);
  Rig rig = simulate::Simulator(test::TinyOptions()).rig();
  CameraSpec camera = world.spec;
  camera.camera_from_lidar_guess = GuessOff(world.camera_from_lidar, 0.02, 0.03, 5);
  rig.cameras = {camera};
  const RigText text = test::TextOf(ParseRig(PrintRig(rig), "test rig"));
  ViewDetection stranger = world.views[0];
  stranger.images[0].camera = "front";
  // Its edges lie outside of the image: the paper's distance transform has nothing to go by.
  ViewDetection outside = world.views[1];
  for (auto& pixel : outside.images[0].edges->edge_pixels) pixel = {-100, -100};

  CalibrateOptions by_paper;
  by_paper.method = kPaperMethod;
  SolverNode node(by_paper), twin(by_paper);
  Twins twins(&node, &twin, ForgetDurations);
  twins.bad = {Garbage(), stranger};
  Messages good = {text};
  good.insert(good.end(), world.views.begin(), world.views.begin() + 4);
  twins.Feed(good);
  twins.bad.push_back(outside);
  SessionCommand solve;
  solve.verb = SessionVerb::kSolve;
  twins.Feed({world.views[4], solve, world.views[5], solve});
  EXPECT_THAT(twins.refused, Each(Gt(3)));
}

TEST(Refusal, Session) {
  const test::TempDir dir;
  using Kind = SessionStep::Kind;
  const SessionScript script = test::Script(
      {Kind::kNextPose, Kind::kSweep, Kind::kCapture, Kind::kSolve, Kind::kEvaluate, Kind::kSave});
  SessionNode node(script, TinyRig(), dir / "a", {});
  SessionNode twin(script, TinyRig(), dir / "b", {});
  Twins twins(&node, &twin, [&](Message* message) {
    auto* event = std::get_if<SessionEvent>(message);
    if (event != nullptr && event->text.rfind("saved to ", 0) == 0) event->text = "saved";
  });
  SessionRequest request;
  request.request = SessionRequestKind::kCapture;
  twins.bad = {WrongSize(), OfAStranger(), PicksOf("front", kStart), request,
               ReportText{0, kStart, "{ \"nonsense\""}};
  for (const char* process : {"assembler", "detector", "solver", "fuser"}) {
    twins.Feed({test::Ready(process)});
  }
  // The commands are those of a third one, that gets nothing else.
  SessionNode leader(script, TinyRig(), dir / "c", {});
  for (const char* process : {"assembler", "detector", "solver", "fuser"}) {
    leader.Handle(test::Ready(process));
  }
  test::World world;
  for (int t = 0; t < 20 && !leader.finished(); ++t) {
    for (const SessionCommand& command : test::Only<SessionCommand>(leader.Advance(t * kSecond))) {
      const Messages answers = world.Answer(command);
      test::HandleAll(&leader, answers);
      twins.Feed(answers);
    }
  }
  twins.Feed({test::Ready("solver")});
  EXPECT_THAT(twins.refused, Each(Gt(10)));
  EXPECT_TRUE(node.finished());
  EXPECT_EQ(node.failure(), "");
}

// Corners for a view that cannot be written once more.
TEST(Refusal, SessionWhoseDiskFails) {
  const test::TempDir dir;
  SessionNode node(TinyRig(), dir / "session", {});
  for (const char* process : {"assembler", "detector", "solver", "fuser"}) {
    node.Handle(test::Ready(process));
  }
  SessionRequest capture;
  capture.request = SessionRequestKind::kCapture;
  node.Advance(0);
  node.Handle(capture);
  test::World world;
  for (int t = 1; t < 20; ++t) {
    for (const SessionCommand& command : test::Only<SessionCommand>(node.Advance(t * kSecond))) {
      test::HandleAll(&node, world.Answer(command));
    }
  }
  ASSERT_TRUE(std::filesystem::exists(dir / "session/views/0001/view.textproto"));
  const Status before = node.GetStatus();
  const CornerSelection picks =
      PicksOf("rgb", ReadView(OpenSession(dir / "session"), "0001").images[0].utime);
  std::filesystem::rename(dir / "session/views/0001", dir / "elsewhere");
  EXPECT_THROW(node.Handle(picks), InputError);
  std::filesystem::rename(dir / "elsewhere", dir / "session/views/0001");
  EXPECT_EQ(node.GetStatus().text, before.text);
  EXPECT_TRUE(ReadView(OpenSession(dir / "session"), "0001").picks.empty());
  node.Handle(picks);
  EXPECT_EQ(ReadView(OpenSession(dir / "session"), "0001").picks.size(), 1U);
}

// It takes any command as it is, and nothing else does anything.
TEST(Refusal, SimulatorRefusesNothing) {
  SimulatorNode node(test::TinyOptions()), twin(test::TinyOptions());
  for (const Message& message :
       Messages{Garbage(), WrongSize(), Pose(kStart, 1), test::Ready("solver")}) {
    EXPECT_TRUE(node.Handle(message).empty());
  }
  SessionCommand pose;
  pose.verb = SessionVerb::kNextPose;
  Twins twins(&node, &twin);
  twins.Feed({pose, pose});
}

}  // namespace
}  // namespace rgbdt
