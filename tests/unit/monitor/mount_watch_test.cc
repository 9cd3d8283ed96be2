#include "calib/monitor/mount_watch.h"

#include <gmock/gmock.h>

#include <opencv2/core.hpp>

#include "calib/model/errors.h"
#include "tests/numbers.h"
#include "tests/unit/methods/scene/scene_world.h"

namespace rgbdt {
namespace {

using testing::HasSubstr;

// A furnished room, looked at by small cameras (a pixel is 0.21 degrees) from a rig that drives on.
const SceneWorld& Room() {
  static const SceneWorld world(7, [] {
    simulate::Options options = SmallScene();
    options.scene = simulate::Scene::kIndoor;
    options.natural.on = true;
    return options;
  }());
  return world;
}

CameraCalibration CalibratedAt(const Rigid3& pose, const std::string& camera) {
  CameraCalibration calibration;
  calibration.camera = camera;
  calibration.camera_from_lidar = pose;
  calibration.status = SolveStatus::kConverged;
  calibration.covariance =
      Matrix6d((Vector6d() << 1e-7, 1e-7, 1e-7, 1e-6, 1e-6, 1e-6).finished().asDiagonal());
  return calibration;
}

std::vector<MountCheck> Watched(std::size_t camera, const Rigid3& pose) {
  const CameraSpec& spec = Room().rig().cameras[camera];
  MountWatch watch(spec);
  watch.SetCalibration(CalibratedAt(pose, spec.name), 42);
  std::vector<MountCheck> checks;
  for (const Shot& shot : Room().Shots(camera)) checks.push_back(watch.Add(shot));
  return checks;
}

TEST(MountWatch, AMountThatHoldsIsLeftInPeace) {
  for (std::size_t camera = 0; camera < 2; ++camera) {
    const Rigid3& truth = Room().Truth(camera);
    const std::vector<MountCheck> checks = Watched(camera, truth);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(checks[i].state, MountState::kCannotTell);
      EXPECT_FALSE(checks[i].holds);
      EXPECT_THAT(checks[i].text, HasSubstr("of 3 sweeps seen"));
    }
    for (std::size_t i = 2; i < checks.size(); ++i) {
      EXPECT_EQ(checks[i].state, MountState::kHolds) << i << " " << checks[i].text;
      EXPECT_EQ(checks[i].calibration_utime, 42);
      ASSERT_TRUE(checks[i].holds);
      EXPECT_GT(*checks[i].holds, 0.9);
      double where = 0;
      for (const double share : checks[i].where) where += share;
      EXPECT_NEAR(where, 1, 1e-9);
      EXPECT_GT(checks[i].edges, 50);
    }
  }
}

// Seven pixels: both ways about each axis would do as well.
TEST(MountWatch, AKnockIsNoticedAndMeasured) {
  for (std::size_t camera = 0; camera < 2; ++camera) {
    const Rigid3& truth = Room().Truth(camera);
    const Rigid3 before = RotationAbout(Eigen::Vector3d::UnitY(), -1.2 * kDegree) * truth;
    const MountCheck check = Watched(camera, before).back();
    ASSERT_EQ(check.state, MountState::kMoved) << check.text;
    EXPECT_LT(*check.holds, 0.01);
    EXPECT_LT(ErrorOf(check.camera_from_lidar, truth).rotation_deg, 0.3);
    EXPECT_NEAR(check.moved[1], 1.2 * kDegree, 0.3 * kDegree);
    EXPECT_LT(RotationDistance(Exp(check.moved) * before, check.camera_from_lidar), 1e-6);
    EXPECT_THAT(check.text, HasSubstr("mostly a turn about the camera's y (yaw)"));
  }
}

// The LIDAR is turned about the camera's y, by 19 pixels: its clouds are, too.
TEST(MountWatch, ALargeKnockIsFound) {
  const Rigid3& truth = Room().Truth(0);
  const Rigid3 turn = RotationAbout(Eigen::Vector3d::UnitY(), 4 * kDegree);
  const Rigid3 knock = truth.Inverse() * turn.Inverse() * truth;
  const CameraSpec& spec = Room().rig().cameras[0];
  MountWatch watch(spec);
  watch.SetCalibration(CalibratedAt(truth, spec.name), 1);
  const std::vector<Shot> shots = Room().Shots(0);
  for (const Shot& shot : shots) watch.Add(shot);
  MountCheck check;
  for (const Shot& shot : shots) {
    Cloud knocked = *shot.cloud;
    for (auto& point : knocked.points) point = (knock * point.cast<double>().eval()).cast<float>();
    for (auto& direction : knocked.directions) {
      direction = (knock.rotation * direction.cast<double>()).cast<float>();
    }
    check = watch.Add({shot.view, &knocked, shot.image});
  }
  ASSERT_EQ(check.state, MountState::kMoved) << check.text;
  EXPECT_LT(*check.holds, 1e-6);
  EXPECT_LT(ErrorOf(check.camera_from_lidar, turn * truth).rotation_deg, 0.3);
}

TEST(MountWatch, AnImageOfNothingTellsNothing) {
  const CameraSpec& spec = Room().rig().cameras[0];
  MountWatch watch(spec);
  watch.SetCalibration(CalibratedAt(Room().Truth(0), spec.name), 1);
  MountCheck check;
  for (const Shot& shot : Room().Shots(0)) {
    Image fog = *shot.image;
    fog.pixels = cv::Mat(fog.pixels.size(), fog.pixels.type(), cv::Scalar::all(128));
    check = watch.Add({shot.view, shot.cloud, &fog});
  }
  EXPECT_EQ(check.state, MountState::kCannotTell);
  EXPECT_FALSE(check.holds);
  EXPECT_FALSE(check.text.empty());
  EXPECT_EQ(check.camera_from_lidar.translation, Room().Truth(0).translation);
}

// What used to fit and does not any more is no matter of the scene.
TEST(MountWatch, ACameraThatIsTurnedAwayIsLost) {
  const CameraSpec& spec = Room().rig().cameras[0];
  MountWatch watch(spec);
  watch.SetCalibration(CalibratedAt(Room().Truth(0), spec.name), 1);
  const std::vector<Shot> shots = Room().Shots(0);
  for (const Shot& shot : shots) watch.Add(shot);
  MountCheck check;
  for (const Shot& shot : shots) {
    Image turned = *shot.image;
    turned.pixels = cv::Mat();  // a copy of an image shares its pixels
    cv::rotate(shot.image->pixels, turned.pixels, cv::ROTATE_180);
    check = watch.Add({shot.view, shot.cloud, &turned});
  }
  EXPECT_EQ(check.state, MountState::kLost) << check.text;
  EXPECT_THAT(check.text, HasSubstr("does not fit any more"));
}

TEST(MountWatch, AnotherCalibrationIsWatchedFromItsFirstSweepOn) {
  const CameraSpec& spec = Room().rig().cameras[0];
  const Rigid3& truth = Room().Truth(0);
  MountWatch watch(spec);
  const std::vector<Shot> shots = Room().Shots(0);
  EXPECT_THAT(watch.Add(shots[0]).text, HasSubstr("no calibration"));
  watch.SetCalibration(
      CalibratedAt(RotationAbout(Eigen::Vector3d::UnitY(), 1.2 * kDegree) * truth, spec.name), 1);
  for (std::size_t i = 1; i < 6; ++i) watch.Add(shots[i]);
  watch.SetCalibration(CalibratedAt(truth, spec.name), 2);
  const MountCheck check = watch.Add(shots[6]);
  EXPECT_EQ(check.state, MountState::kHolds) << check.text;
  EXPECT_EQ(check.calibration_utime, 2);
}

TEST(MountWatch, ACalibrationWithAnotherTimingIsAnother) {
  const CameraSpec& spec = Room().rig().cameras[0];
  MountWatch watch(spec);
  CameraCalibration calibration = CalibratedAt(Room().Truth(0), spec.name);
  watch.SetCalibration(calibration, 1);
  calibration.timing = CameraTiming{{0.2, 1e-4}, {0, 1e-5}};
  watch.SetCalibration(calibration, 1);
  EXPECT_TRUE(watch.calibration()->timing == calibration.timing);
}

TEST(MountWatch, OptionsThatMakeNoSenseAreRefused) {
  const auto refused = [](auto change) {
    WatchOptions options;
    change(&options);
    EXPECT_THROW(options.Check(), InputError);
  };
  refused([](auto* o) { o->sweeps = 2; });
  refused([](auto* o) { o->moved_m.pop_back(); });
  refused([](auto* o) { o->moved_share = 0; });
  refused([](auto* o) { o->alarm = 0.6; });
}

}  // namespace
}  // namespace rgbdt
