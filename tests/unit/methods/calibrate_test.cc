#include "calib/methods/calibrate.h"

#include <algorithm>

#include "calib/camera/camera.h"
#include "calib/methods/paper/by_paper.h"
#include "tests/numbers.h"
#include "tests/unit/solve/board_world.h"

namespace rgbdt {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Rig RigOf(const BoardWorld& world, const Rigid3& guess) {
  Rig rig;
  rig.hash = "hash";
  rig.cameras = {world.spec};
  rig.cameras[0].camera_from_lidar_guess = guess;
  return rig;
}

// RMS distance [px] between where two calibrations lay the boundary points of all the views.
double ReprojectionRms(const BoardWorld& world, const Rigid3& a, const Rigid3& b) {
  const Camera camera(world.spec);
  double squares = 0;
  double count = 0;
  for (const ViewDetection& view : world.views) {
    for (const Eigen::Vector3d& p : view.cloud.candidates[0].boundary) {
      const auto at_a = camera.Project(a * p);
      const auto at_b = camera.Project(b * p);
      if (!at_a || !at_b) return 1e9;
      squares += (*at_a - *at_b).squaredNorm();
      count += 1;
    }
  }
  return std::sqrt(squares / count);
}

// Enough for Levenberg-Marquardt to come to rest: the objective jumps wherever a point crosses from
// one pixel's surface to the next, so it wanders before it does.
CalibrateOptions Patient() {
  CalibrateOptions options;
  options.method = kPaperMethod;
  options.max_iterations = 3000;
  return options;
}

// For what does not depend on where the solve ends.
CalibrateOptions Hasty() {
  CalibrateOptions options;
  options.method = kPaperMethod;
  options.max_iterations = 8;
  return options;
}

class SolvePaperFrom : public testing::TestWithParam<std::uint32_t> {};

TEST_P(SolvePaperFrom, TwoDegreesAndFiveCentimetresRecoversThePoseWithinThePixelGrid) {
  const BoardWorld world = MakeBoardWorld(12, GetParam());
  const Rigid3 start = GuessOff(world.camera_from_lidar, 2 * kDegree, 0.05, GetParam());
  ASSERT_GT(ReprojectionRms(world, start, world.camera_from_lidar), 5);
  const CameraCalibration result =
      SolvePaper(world.spec, PointersTo(world.Used()), start, Patient());
  EXPECT_EQ(result.camera, "rgb");
  EXPECT_EQ(result.status, SolveStatus::kConverged);
  // Edge pixels lie on integers: half a pixel is what the grid can move an outline by.
  EXPECT_LT(ReprojectionRms(world, result.camera_from_lidar, world.camera_from_lidar), 0.5);
  // Half a pixel at f = 500 px is 1 mrad; at the mean distance of 3.25 m, 3.3 mm. Rotation and
  // translation trade with one another, as the boards' distances hardly tell them apart: four
  // times as much.
  EXPECT_THAT(result.camera_from_lidar,
              Rigid3Near(world.camera_from_lidar, 4 * 0.5 / 500, 4 * 3.25 * 0.5 / 500));
}

INSTANTIATE_TEST_SUITE_P(Seeds, SolvePaperFrom, testing::Range(1U, 6U));

TEST(SolvePaper, WhereNothingProjectsIntoTheImageItHasNotConverged) {
  const BoardWorld world = MakeBoardWorld(6);
  // Half a turn about the camera's y: all points lie behind it, and the objective is flat.
  const Rigid3 start = RotationAbout({0, 1, 0}, M_PI) * world.camera_from_lidar;
  const CameraCalibration result = SolvePaper(world.spec, PointersTo(world.Used()), start, {});
  EXPECT_EQ(result.status, SolveStatus::kNotConverged);
  EXPECT_THAT(result.detail, HasSubstr("only 0% of the boundary points project into the image"));
}

// Of starts so far off that points lie outside the images: the paper's field is flat there.
TEST(SolvePaper, TheSmoothFieldLeadsBackFromWhereThePapersIsFlat) {
  const BoardWorld world = MakeBoardWorld(9);
  CalibrateOptions smooth = Patient();
  smooth.smooth_field = true;
  // All points behind the camera, or beside the image.
  for (const double angle : {M_PI, 0.6 * M_PI}) {
    const Rigid3 start = RotationAbout({0, 1, 0}, angle) * world.camera_from_lidar;
    const CameraCalibration paper =
        SolvePaper(world.spec, PointersTo(world.Used()), start, Patient());
    EXPECT_FALSE(paper.converged());
    EXPECT_GT(RotationDistance(paper.camera_from_lidar, world.camera_from_lidar), 1);
    const CameraCalibration found = SolvePaper(world.spec, PointersTo(world.Used()), start, smooth);
    EXPECT_TRUE(found.converged()) << found.detail;
    EXPECT_LT(ReprojectionRms(world, found.camera_from_lidar, world.camera_from_lidar), 0.5);
  }
}

TEST(SolvePaper, WithTheSmoothFieldPointsNeedNotLieInTheImage) {
  const BoardWorld world = MakeBoardWorld(6);
  CalibrateOptions options;
  options.smooth_field = true;
  const Rigid3 start = RotationAbout({0, 1, 0}, M_PI) * world.camera_from_lidar;
  options.max_iterations = 2;
  const CameraCalibration result = SolvePaper(world.spec, PointersTo(world.Used()), start, options);
  EXPECT_THAT(result.detail, testing::Not(HasSubstr("project into the image")));
}

TEST(SolvePaper, RunningOutOfIterationsIsAStatus) {
  const BoardWorld world = MakeBoardWorld(6);
  CalibrateOptions options;
  options.max_iterations = 1;
  const Rigid3 start = GuessOff(world.camera_from_lidar, 2 * kDegree, 0.05, 1);
  const CameraCalibration result = SolvePaper(world.spec, PointersTo(world.Used()), start, options);
  EXPECT_EQ(result.status, SolveStatus::kNotConverged);
  EXPECT_NE(result.detail, "");
}

TEST(TurnedStart, RollsAboutTheLidarsXThenYawsAboutItsZ) {
  const Rigid3 camera_from_lidar = WorldTruth();
  const double roll = 30 * kDegree;
  const double yaw = 40 * kDegree;
  const auto in_lidar = [&](const Rigid3& start, const Eigen::Vector3d& point) {
    return Eigen::Vector3d(camera_from_lidar.Inverse() * (start * point));
  };
  // Roll alone: x stays, y goes towards z. Yaw alone: z stays, x goes towards y.
  const Rigid3 rolled = TurnedStart(camera_from_lidar, roll, 0);
  EXPECT_THAT(in_lidar(rolled, {1, 0, 0}), EigenNear(Eigen::Vector3d(1, 0, 0), 1e-12));
  EXPECT_THAT(in_lidar(rolled, {0, 1, 0}),
              EigenNear(Eigen::Vector3d(0, std::cos(roll), std::sin(roll)), 1e-12));
  const Rigid3 yawed = TurnedStart(camera_from_lidar, 0, yaw);
  EXPECT_THAT(in_lidar(yawed, {0, 0, 1}), EigenNear(Eigen::Vector3d(0, 0, 1), 1e-12));
  EXPECT_THAT(in_lidar(yawed, {1, 0, 0}),
              EigenNear(Eigen::Vector3d(std::cos(yaw), std::sin(yaw), 0), 1e-12));
  EXPECT_NEAR(RotationDistance(rolled, camera_from_lidar), roll, 1e-12);
  EXPECT_NEAR(RotationDistance(yawed, camera_from_lidar), yaw, 1e-12);
  // Both: roll first. x only yaws; z rolls towards -y, and that yaws towards x.
  const Rigid3 both = TurnedStart(camera_from_lidar, roll, yaw);
  EXPECT_THAT(in_lidar(both, {1, 0, 0}),
              EigenNear(Eigen::Vector3d(std::cos(yaw), std::sin(yaw), 0), 1e-12));
  EXPECT_THAT(in_lidar(both, {0, 0, 1}),
              EigenNear(Eigen::Vector3d(std::sin(roll) * std::sin(yaw),
                                        -std::sin(roll) * std::cos(yaw), std::cos(roll)),
                        1e-12));
}

TEST(TurnedStart, TheDefaultsAreThePapersAngles) {
  EXPECT_NEAR(CalibrateOptions().wide_roll_rad, 30 * kDegree, 1e-15);
  EXPECT_NEAR(CalibrateOptions().wide_yaw_rad, 40 * kDegree, 1e-15);
}

class CalibrateTest : public testing::Test {
 protected:
  const BoardWorld world_ = MakeBoardWorld(9);
  const Rigid3 guess_ = GuessOff(world_.camera_from_lidar, 1 * kDegree, 0.03, 2);
  const Rig rig_ = RigOf(world_, guess_);
};

TEST_F(CalibrateTest, ReportsViewsQualityAndWhereItComesFrom) {
  std::vector<ViewDetection> detections = world_.views;
  detections[4].images[0].why_not = "no board";
  detections[4].images[0].edges.reset();
  const Report report = Calibrate(rig_, detections, Patient());
  EXPECT_EQ(report.method, "paper");
  EXPECT_EQ(report.rig_hash, "hash");
  ASSERT_EQ(report.cameras.size(), 1U);
  const CameraReport& camera = report.cameras[0];
  EXPECT_THAT(camera.used, ElementsAre("0", "1", "3", "6", "7"));
  EXPECT_THAT(camera.heldout, ElementsAre("2", "5", "8"));
  ASSERT_EQ(camera.rejected.size(), 1U);
  EXPECT_EQ(camera.rejected[0].view, "4");
  EXPECT_EQ(camera.rejected[0].why, "no board");
  ASSERT_EQ(report.detections.size(), 9U);
  EXPECT_EQ(report.detections[4].view, "4");
  EXPECT_EQ(report.detections[4].images.at(0).why_not, "no board");
  EXPECT_EQ(report.detections[4].cloud_candidates, 1);
  EXPECT_EQ(report.detections[4].cloud_why_not, "");
  EXPECT_EQ(report.detections[5].images.at(0).why_not, "");
  EXPECT_TRUE(report.detections[5].heldout);
  EXPECT_EQ(camera.views.size(), 8U);
  EXPECT_TRUE(camera.calibration.converged());
  EXPECT_THAT(camera.first_guess.value(), Rigid3Near(guess_, 0.0, 0.0));
  EXPECT_LT(ReprojectionRms(world_, camera.calibration.camera_from_lidar, world_.camera_from_lidar),
            0.5);
  // On pixels drawn from the truth: a rounding (0.5 px) and the grid's diagonal at most.
  EXPECT_LT(camera.distance_transform_px.train.value(), 1.0);
  EXPECT_LT(camera.distance_transform_px.heldout.value(), 1.0);
  EXPECT_LT(camera.edge_rms_px.heldout.value(), 1.0);
  ASSERT_EQ(camera.other_starts.size(), 1U);
  EXPECT_THAT(camera.other_starts[0].start, HasSubstr("30 deg roll and 40 deg yaw"));
}

TEST_F(CalibrateTest, HeldOutViewsDoNotTouchTheResult) {
  std::vector<ViewDetection> without = world_.views;
  without.erase(
      std::remove_if(without.begin(), without.end(), [](auto& view) { return view.heldout; }),
      without.end());
  const Rigid3 a = Calibrate(rig_, world_.views, Hasty()).cameras[0].calibration.camera_from_lidar;
  const Rigid3 b = Calibrate(rig_, without, Hasty()).cameras[0].calibration.camera_from_lidar;
  EXPECT_EQ(a.rotation.coeffs(), b.rotation.coeffs());
  EXPECT_EQ(a.translation, b.translation);
}

TEST_F(CalibrateTest, TheOrderOfTheDetectionsDoesNotMatterToTheLastBit) {
  std::vector<ViewDetection> shuffled = world_.views;
  ViewDetection again = shuffled[0];  // a name may come twice
  again.sweep_utime += 500;
  again.cloud.candidates[0].boundary.resize(100);
  std::vector<ViewDetection> straight = shuffled;
  straight.push_back(again);
  shuffled.insert(shuffled.begin(), again);
  std::reverse(shuffled.begin() + 3, shuffled.end());
  const CameraReport a = Calibrate(rig_, straight, Hasty()).cameras[0];
  const CameraReport b = Calibrate(rig_, shuffled, Hasty()).cameras[0];
  EXPECT_EQ(a.calibration.camera_from_lidar.rotation.coeffs(),
            b.calibration.camera_from_lidar.rotation.coeffs());
  EXPECT_EQ(a.calibration.camera_from_lidar.translation,
            b.calibration.camera_from_lidar.translation);
  EXPECT_EQ(a.distance_transform_px.train, b.distance_transform_px.train);
  EXPECT_EQ(a.edge_rms_px.heldout, b.edge_rms_px.heldout);
  EXPECT_EQ(a.used, b.used);
  EXPECT_EQ(a.other_starts[0].distance_transform_px, b.other_starts[0].distance_transform_px);
}

TEST_F(CalibrateTest, TooFewViewsKeepTheGuessAndSaySo) {
  const std::vector<ViewDetection> two = {world_.views[0], world_.views[1], world_.views[2]};
  const CameraReport report = Calibrate(rig_, two, Hasty()).cameras[0];  // the third is held out
  EXPECT_EQ(report.calibration.status, SolveStatus::kNotSolved);
  EXPECT_THAT(report.calibration.detail, HasSubstr("2 usable views, at least 3"));
  EXPECT_THAT(report.calibration.camera_from_lidar, Rigid3Near(guess_, 0.0, 0.0));
  EXPECT_FALSE(report.distance_transform_px.train);
  EXPECT_TRUE(report.other_starts.empty());
}

TEST_F(CalibrateTest, AWellFormedDetectionWithNothingInItIsRejectedWithAReason) {
  std::vector<ViewDetection> detections = world_.views;
  detections[0].images[0].edges->edge_pixels.clear();
  detections[1].cloud.candidates[0].boundary.clear();
  detections[3].images[0].edges->width = 320;
  detections[4].cloud.candidates.clear();
  const CameraReport report = Calibrate(rig_, detections, Hasty()).cameras[0];
  ASSERT_EQ(report.rejected.size(), 4U);
  EXPECT_THAT(report.rejected[0].why, HasSubstr("no edges in the image"));
  EXPECT_THAT(report.rejected[1].why, HasSubstr("no boundary points"));
  EXPECT_THAT(report.rejected[2].why, HasSubstr("320x480"));
  EXPECT_THAT(report.rejected[3].why, HasSubstr("not found in the cloud"));
  EXPECT_THAT(report.used, ElementsAre("6", "7"));
}

TEST_F(CalibrateTest, CamerasAreCalibratedEachByItself) {
  Rig rig = rig_;
  rig.cameras.push_back(rig.cameras[0]);
  rig.cameras[1].name = "thermal";
  const Report report = Calibrate(rig, world_.views, Hasty());
  ASSERT_EQ(report.cameras.size(), 2U);
  EXPECT_EQ(report.cameras[0].used.size(), 6U);
  EXPECT_TRUE(report.cameras[0].distance_transform_px.train);
  EXPECT_EQ(report.cameras[1].calibration.camera, "thermal");
  EXPECT_THAT(report.cameras[1].calibration.detail, HasSubstr("0 usable views"));
}

TEST_F(CalibrateTest, AutoSaysWhatItLacksWhereNothingHasAPose) {
  const CameraReport report = Calibrate(rig_, world_.views).cameras[0];
  EXPECT_EQ(report.calibration.status, SolveStatus::kNotSolved);
  EXPECT_FALSE(report.first_guess);
  EXPECT_THAT(report.calibration.detail, HasSubstr("both camera and LIDAR see the board"));
}

TEST_F(CalibrateTest, AnUnknownMethodIsAnInputErrorThatSaysWhichThereAre) {
  CalibrateOptions options;
  options.method = "magic";
  const std::string message = InputErrorOf([&] { Calibrate(rig_, world_.views, options); });
  EXPECT_THAT(message, HasSubstr("\"magic\""));
  EXPECT_THAT(message, HasSubstr("paper"));
}

TEST_F(CalibrateTest, BadOptionsAreNamed) {
  CalibrateOptions options;
  options.min_views = 0;
  EXPECT_THAT(InputErrorOf([&] { options.Check(); }), HasSubstr("min_views is 0"));
  options = {};
  options.max_iterations = -3;
  EXPECT_THAT(InputErrorOf([&] { options.Check(); }), HasSubstr("max_iterations is -3"));
}

TEST_F(CalibrateTest, EvaluateJudgesACalibrationWithoutChangingIt) {
  Calibration calibration;
  calibration.method = "paper";
  calibration.utime = 5;
  calibration.cameras.resize(1);
  calibration.cameras[0].camera = "rgb";
  calibration.cameras[0].camera_from_lidar = world_.camera_from_lidar;
  const Report report = Evaluate(rig_, world_.views, calibration);
  ASSERT_EQ(report.cameras.size(), 1U);
  const CameraReport& camera = report.cameras[0];
  EXPECT_EQ(report.utime, 5);
  EXPECT_THAT(camera.calibration.camera_from_lidar, Rigid3Near(world_.camera_from_lidar, 0.0, 0.0));
  // The truth lies on the outline; and on edge pixels, which are its rounded points.
  EXPECT_LT(camera.edge_rms_px.train.value(), 1e-3);
  EXPECT_LT(camera.edge_rms_px.heldout.value(), 1e-3);
  EXPECT_LT(camera.distance_transform_px.train.value(), 0.02);
  EXPECT_EQ(camera.views.size(), 9U);

  calibration.cameras[0].camera_from_lidar = guess_;
  EXPECT_GT(Evaluate(rig_, world_.views, calibration).cameras[0].edge_rms_px.train.value(), 2);
  calibration.cameras[0].camera = "other";
  EXPECT_TRUE(Evaluate(rig_, world_.views, calibration).cameras.empty());
}

}  // namespace
}  // namespace rgbdt
