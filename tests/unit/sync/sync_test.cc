#include "calib/sync/sync.h"

#include <algorithm>
#include <cmath>

#include "calib/model/errors.h"
#include "tests/study/waved_boards.h"
#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

using study::WavedScene;

constexpr std::size_t kColor = 0, kThermal = 1;

WavedScene Short(WavedScene scene) {
  scene.seconds = 10;
  return scene;
}

SyncResult SolveNearTruth(const WavedScene& scene) {
  Truth truth;
  WavedBoard board = study::SampleWavedBoard(scene, &truth);
  study::BeginNearTruth(truth, 0.01, 0.02, &board);
  return Synchronise(board);
}

void ExpectNear(const Estimate& found, double truth, double most) {
  EXPECT_NEAR(found.value, truth, most);
  EXPECT_GT(found.sigma, 0);
  EXPECT_LT(std::abs(found.value - truth), 4.5 * found.sigma);
}

bool Warns(const SyncedCamera& camera, const std::string& of) {
  for (const std::string& warning : camera.warnings) {
    if (warning.find(of) != std::string::npos) return true;
  }
  return false;
}

TEST(SyncTest, FindsOffsetsAndReadOutsOfTwoCameras) {
  WavedScene scene = Short(study::TwoCameras(11));
  scene.clocks[kColor].offset_s = 0.31;
  scene.clocks[kColor].rolling_s = 0.02;
  scene.clocks[kThermal].offset_s = -0.47;
  scene.clocks[kThermal].rolling_s = -0.01;  // from below
  const SyncResult result = SolveNearTruth(scene);
  for (const std::size_t i : {kColor, kThermal}) {
    const SyncedCamera& camera = result.cameras[i];
    EXPECT_EQ(camera.why_not, "");
    ExpectNear(camera.time_offset_s, scene.clocks[i].offset_s, 5e-4);
    ExpectNear(camera.rolling_s, scene.clocks[i].rolling_s, 5e-4);
    EXPECT_FALSE(camera.drift.has_value());
    EXPECT_FALSE(camera.jump.has_value());
    EXPECT_EQ(camera.repeated, 0);
    EXPECT_GE(camera.offsets.size(), 4U);
  }
  EXPECT_GT(result.sweeps, 80);
}

TEST(SyncTest, TheRigMayTurnBeforeABoardThatStands) {
  WavedScene scene = Short(study::TwoCameras(15));
  scene.wave.reach_m = scene.wave.turn_rad = {0, 0, 0};
  scene.wave.rig_turn_rad = {0.05, 0.15, 0.2};
  scene.clocks[kColor].offset_s = 0.21;
  scene.clocks[kColor].rolling_s = 0.02;
  scene.clocks[kThermal].offset_s = -0.37;
  const SyncResult result = SolveNearTruth(scene);
  for (const std::size_t i : {kColor, kThermal}) {
    const SyncedCamera& camera = result.cameras[i];
    EXPECT_EQ(camera.why_not, "");
    ExpectNear(camera.time_offset_s, scene.clocks[i].offset_s, 1e-3);  // moves by a third of a wave
    ExpectNear(camera.rolling_s, scene.clocks[i].rolling_s, 5e-4);
  }
  EXPECT_GT(result.turn_speed, 0.2);
}

TEST(SyncTest, NeedsNoPoseToBeginFrom) {
  WavedScene scene = Short(study::ColorCamera(12));
  scene.clocks[0].offset_s = -0.62;
  Truth truth;
  WavedBoard board = study::SampleWavedBoard(scene, &truth);
  study::AddSweepBoards(scene, &board);
  const SyncedCamera camera = Synchronise(board).cameras[0];
  EXPECT_EQ(camera.why_not, "");
  ExpectNear(camera.time_offset_s, -0.62, 5e-4);
  const Rigid3& pose = truth.camera_from_lidar.at("rgb");
  EXPECT_LT(RotationDistance(pose, camera.camera_from_lidar), 0.1 * M_PI / 180);
  const Vector6d off = Log(pose * camera.camera_from_lidar.Inverse());
  EXPECT_LT(off.dot(camera.covariance.ldlt().solve(off)), 25);  // 6 numbers; once in 3000
}

TEST(SyncTest, EvenWavingDoesNotTellWithoutAPose) {
  WavedScene scene = Short(study::ColorCamera(23));
  scene.clocks[0].offset_s = 0.5;
  scene.wave.slowest_hz = scene.wave.fastest_hz = 0.8;  // as after 1.25 s: at -0.75 s, too
  WavedBoard board = study::SampleWavedBoard(scene, nullptr);
  study::AddSweepBoards(scene, &board);
  const SyncedCamera camera = Synchronise(board).cameras[0];
  EXPECT_THAT(camera.why_not, testing::HasSubstr("more than one offset fits alike"));
}

TEST(SyncTest, APoseThatIsKnownStays) {
  WavedScene scene = Short(study::ColorCamera(13));
  Truth truth;
  WavedBoard board = study::SampleWavedBoard(scene, &truth);
  study::BeginNearTruth(truth, 0, 0, &board);
  board.cameras[0].covariance = Matrix6d::Identity() * 1e-12;
  const SyncedCamera camera = Synchronise(board).cameras[0];
  EXPECT_LT(CentreDistance(truth.camera_from_lidar.at("rgb"), camera.camera_from_lidar), 2e-5);
  EXPECT_LT(camera.covariance.trace(), 6.1e-12);
}

TEST(SyncTest, ABoardThatHardlyMovesTellsNothing) {
  WavedScene scene = Short(study::ColorCamera(14));
  scene.seconds = 3;
  scene.wave.reach_m.setConstant(0.003);
  scene.wave.turn_rad.setConstant(0.003);
  const SyncedCamera camera = SolveNearTruth(scene).cameras[0];
  EXPECT_THAT(camera.why_not, testing::HasSubstr("hardly moves"));
}

TEST(SyncTest, ABoardThatOneCameraDoesNotSeeAtFirstLosesNothing) {
  WavedScene scene = Short(study::TwoCameras(20));
  scene.clocks[kThermal].offset_s = 0.2;
  Truth truth;
  WavedBoard board = study::SampleWavedBoard(scene, &truth);
  study::BeginNearTruth(truth, 0.01, 0.02, &board);
  std::vector<WavedImage>& images = board.cameras[kThermal].images;
  const Utime from = scene.wave.start + FromSeconds(3);
  images.erase(std::remove_if(images.begin(), images.end(),
                              [&](const WavedImage& image) { return image.utime < from; }),
               images.end());
  const SyncResult result = Synchronise(board);
  for (const std::size_t i : {kColor, kThermal}) {
    EXPECT_EQ(result.cameras[i].why_not, "");
    ExpectNear(result.cameras[i].time_offset_s, scene.clocks[i].offset_s, 1e-3);
    ASSERT_FALSE(result.cameras[i].offsets.empty());
  }
  // What no image tells is not given.
  EXPECT_LT(result.cameras[kColor].offsets.front().seconds, 0.5);
  EXPECT_GT(result.cameras[kThermal].offsets.front().seconds, 1.5);
}

TEST(SyncTest, AFrameThatIsRepeatedCountsOnce) {
  WavedScene scene = Short(study::TwoCameras(15));
  scene.clocks[kThermal].offset_s = 0.2;
  Truth truth;
  WavedBoard board = study::SampleWavedBoard(scene, &truth);
  study::BeginNearTruth(truth, 0.01, 0.02, &board);
  std::vector<WavedImage> images;
  for (const WavedImage& image : board.cameras[kThermal].images) {
    for (const Utime later : {0, 37'000, 74'000}) {  // a core of 9 Hz that sends at 27
      images.push_back(image);
      images.back().utime += later;
    }
  }
  const std::size_t shown = board.cameras[kThermal].images.size();
  board.cameras[kThermal].images = images;
  const SyncedCamera camera = Synchronise(board).cameras[kThermal];
  EXPECT_EQ(camera.repeated, static_cast<int>(2 * shown));
  EXPECT_TRUE(Warns(camera, "show again"));
  ExpectNear(camera.time_offset_s, 0.2, 1e-3);
}

TEST(SyncTest, AClockThatDriftsIsNamed) {
  WavedScene scene = Short(study::ColorCamera(16));
  scene.clocks[0].offset_s = 0.1;
  scene.clocks[0].drift = 300e-6;
  const SyncedCamera camera = SolveNearTruth(scene).cameras[0];
  ASSERT_TRUE(camera.drift.has_value());
  ExpectNear(*camera.drift, 300e-6, 150e-6);
  EXPECT_FALSE(camera.jump.has_value());
  EXPECT_TRUE(Warns(camera, "drifts"));
  EXPECT_NEAR(camera.time_offset_s.value, 0.1 + 5 * 300e-6, 1e-3);
  EXPECT_GT(camera.time_offset_s.sigma, 5e-4);  // as much as it changes
}

TEST(SyncTest, AClockThatJumpsIsNamed) {
  WavedScene scene = Short(study::ColorCamera(17));
  scene.clocks[0].jump_s = 0.006;
  scene.clocks[0].jump_at_s = 6;
  const SyncedCamera camera = SolveNearTruth(scene).cameras[0];
  ASSERT_TRUE(camera.jump.has_value());
  EXPECT_NEAR(camera.jump->offset_s.value, 0.006, 0.002);
  EXPECT_NEAR(camera.jump->seconds, 6, 2);
  EXPECT_TRUE(Warns(camera, "jumps"));
}

TEST(SyncTest, AClockThatJumpsFarHasNoOneOffset) {
  WavedScene scene = Short(study::ColorCamera(17));
  scene.clocks[0].jump_s = 0.03;
  scene.clocks[0].jump_at_s = 6;
  const SyncedCamera camera = SolveNearTruth(scene).cameras[0];
  EXPECT_THAT(camera.why_not, testing::HasSubstr("no one offset holds"));
  EXPECT_TRUE(Warns(camera, "jumps") || Warns(camera, "changes"));
  EXPECT_GE(camera.offsets.size(), 4U);
}

TEST(SyncTest, AnOffsetBeyondTheSearchIsNotMadeUp) {
  WavedScene scene = Short(study::ColorCamera(18));
  scene.clocks[0].offset_s = 2.5;
  const SyncedCamera camera = SolveNearTruth(scene).cameras[0];
  EXPECT_NE(camera.why_not, "");
}

TEST(SyncTest, ALidarWhoseClockWasSetInTheLogIsUsedFromThenOn) {
  WavedScene scene = Short(study::ColorCamera(21));
  scene.clocks[0].offset_s = 0.1;
  Truth truth;
  WavedBoard board = study::SampleWavedBoard(scene, &truth);
  study::BeginNearTruth(truth, 0.01, 0.02, &board);
  for (std::size_t i = 0; i < 10; ++i) {
    for (Utime& utime : board.sweeps[i].utime) utime -= scene.wave.start;  // from 1970
  }
  const SyncResult result = Synchronise(board);
  EXPECT_EQ(result.cameras[0].why_not, "");
  ExpectNear(result.cameras[0].time_offset_s, 0.1, 5e-4);
  EXPECT_GT(result.sweeps, 70);
  EXPECT_LT(result.seconds, 10);
  EXPECT_GE(result.start, scene.wave.start - kMicrosecondsPerSecond);
}

TEST(SyncTest, AnHoursPauseIsRefused) {
  WavedScene scene = Short(study::ColorCamera(22));
  scene.seconds = 4;
  Truth truth;
  WavedBoard board = study::SampleWavedBoard(scene, &truth);
  study::BeginNearTruth(truth, 0.01, 0.02, &board);
  const Utime pause = 3600 * kMicrosecondsPerSecond;
  board.cameras[0].images.back().utime += pause;
  for (Utime& utime : board.sweeps.back().utime) utime += pause;
  try {
    Synchronise(board);
    FAIL() << "taken";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("for 3604 s; expected at most 600 s"));
  }
}

TEST(SyncTest, OneCameraThatFailsLeavesTheOthers) {
  WavedScene scene = Short(study::TwoCameras(19));
  Truth truth;
  WavedBoard board = study::SampleWavedBoard(scene, &truth);
  study::BeginNearTruth(truth, 0.01, 0.02, &board);
  board.cameras[kThermal].images.resize(5);
  const SyncResult result = Synchronise(board);
  EXPECT_EQ(result.cameras[kColor].why_not, "");
  EXPECT_THAT(result.cameras[kThermal].why_not, testing::HasSubstr("5 different images"));
}

TEST(SyncTest, RefusesWhatMakesNoSense) {
  Cloud cloud;
  cloud.lines = 1;
  cloud.beams = 1;
  cloud.points = {{1, 0, 0}};
  EXPECT_THROW(TakeWavedSweep(cloud, 8), InputError);  // no times
  cloud.beams = 2;
  cloud.points.emplace_back(2, 0, 0);
  cloud.utime = {5, 5};
  EXPECT_THROW(TakeWavedSweep(cloud, 8), InputError);  // one of the sweep's
  cloud.utime = {5, 6};
  EXPECT_EQ(TakeWavedSweep(cloud, 8).points.size(), 2U);
  WavedBoard board;
  EXPECT_THROW(Synchronise(board), InputError);  // a plain target
  SyncOptions options;
  options.most_offset_s = -1;
  EXPECT_THROW(options.Check(), InputError);
}

TEST(SyncTest, SaysWhatAnOffsetDoes) {
  CameraSpec spec;
  spec.lens.fx = spec.lens.fy = 1200;
  const std::string text = OffsetInPixels(spec, -0.01);
  EXPECT_THAT(text, testing::HasSubstr("4.0 px at 1 m/s"));
  EXPECT_THAT(text, testing::HasSubstr("12.0 px at 1 rad/s"));
}

}  // namespace
}  // namespace rgbdt
