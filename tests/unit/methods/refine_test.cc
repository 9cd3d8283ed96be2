#include "calib/methods/refine.h"

#include <gmock/gmock.h>

#include "calib/model/errors.h"
#include "calib/model/linear_algebra.h"
#include "tests/numbers.h"
#include "tests/unit/methods/scene/scene_world.h"

namespace rgbdt {
namespace {

using testing::HasSubstr;

/// A furnished room, looked at by small cameras from a rig that drives on.
simulate::Options SmallRoom() {
  simulate::Options options = SmallScene();
  options.scene = simulate::Scene::kIndoor;
  options.natural.on = true;
  return options;
}

std::vector<View> ViewsOf(const SceneWorld& world) {
  std::vector<View> views;
  const std::size_t cameras = world.rig().cameras.size();
  for (std::size_t v = 0; v < world.clouds.size(); ++v) {
    View& view = views.emplace_back();
    view.name = std::to_string(v);
    view.heldout = v % 3 == 2;
    view.cloud = world.clouds[v];
    for (std::size_t c = 0; c < cameras; ++c) view.images.push_back(world.images[v * cameras + c]);
  }
  return views;
}

Calibration StartOff(const SceneWorld& world, double rotation_rad, double translation_m) {
  Calibration start;
  for (std::size_t c = 0; c < world.rig().cameras.size(); ++c) {
    CameraCalibration& camera = start.cameras.emplace_back();
    camera.camera = world.rig().cameras[c].name;
    camera.camera_from_lidar =
        GuessOff(world.Truth(c), rotation_rad, translation_m, static_cast<unsigned>(7 + c));
    camera.status = SolveStatus::kConverged;
  }
  return start;
}

const SceneWorld& Room() {
  static const SceneWorld world(4, SmallRoom());
  return world;
}

TEST(Refine, EndsAtTheTruthAndKnowsHowNear) {
  const SceneWorld& world = Room();
  Calibration start = StartOff(world, 1.5 * kDegree, 0.04);
  start.cameras[1].timing = CameraTiming{{0.1, 1e-4}, {0.02, 1e-4}};
  const Report report = Refine(world.rig(), ViewsOf(world), start);
  ASSERT_EQ(report.cameras.size(), 2U);
  EXPECT_FALSE(report.cameras[0].calibration.timing);
  EXPECT_TRUE(report.cameras[1].calibration.timing == start.cameras[1].timing);
  for (std::size_t c = 0; c < 2; ++c) {
    const CameraReport& camera = report.cameras[c];
    ASSERT_EQ(camera.calibration.status, SolveStatus::kConverged) << camera.calibration.detail;
    const PoseError error = ErrorOf(camera.calibration.camera_from_lidar, world.Truth(c));
    // A pixel is 0.21 degrees here; beams are half a degree apart.
    EXPECT_LT(error.rotation_deg, 0.2);
    EXPECT_LT(error.translation_mm, 15);
    const Vector6d off = Log(world.Truth(c) * camera.calibration.camera_from_lidar.Inverse());
    EXPECT_LT(off.dot(SolveSymmetric(*camera.calibration.covariance, off)), 35);
    ASSERT_TRUE(camera.scene && camera.scene->heldout_result);
    EXPECT_GT(*camera.scene->heldout_result, *camera.scene->heldout_start);
    EXPECT_EQ(camera.heldout.size(), 1U);
  }
}

// The solver's images are moved by some pixels, which looks like a turned camera; those that were
// left out are as they should be.
TEST(Refine, KeepsTheStartWhereTheResultFitsSweepsLeftOutWorse) {
  const SceneWorld& world = Room();
  std::vector<View> views = ViewsOf(world);
  for (View& view : views) {
    for (Image& image : view.images) {
      if (view.heldout) continue;
      const cv::Mat before = image.pixels.clone();
      image.pixels = before.clone();
      before.colRange(0, before.cols - 6).copyTo(image.pixels.colRange(6, before.cols));
    }
  }
  const Report report = Refine(world.rig(), views, StartOff(world, 0, 0));
  for (std::size_t c = 0; c < 2; ++c) {
    const CameraCalibration& found = report.cameras[c].calibration;
    EXPECT_EQ(found.status, SolveStatus::kFirstGuessKept) << found.StatusText();
    EXPECT_THAT(found.detail, HasSubstr("the start fits better"));
    EXPECT_LT(RotationDistance(found.camera_from_lidar, world.Truth(c)), 1e-9);
  }
  // A guess by hand does not become a calibration that way.
  Rig rig = world.rig();
  for (std::size_t c = 0; c < 2; ++c) rig.cameras[c].camera_from_lidar_guess = world.Truth(c);
  EXPECT_EQ(Refine(rig, views, {}).cameras[0].calibration.status, SolveStatus::kNotConverged);
}

TEST(Refine, AStartWithoutACovarianceIsNotJoined) {
  RefineOptions options;
  options.join_start = true;
  EXPECT_THROW(Refine(Room().rig(), ViewsOf(Room()), StartOff(Room(), 0, 0), options), InputError);
}

TEST(Refine, WhatTheStartKnowsIsJoined) {
  const SceneWorld& world = Room();
  Calibration start = StartOff(world, 0.02 * kDegree, 0.001);
  for (CameraCalibration& camera : start.cameras) {
    camera.covariance = Matrix6d(Vector6d::Constant(1e-7).asDiagonal());
  }
  RefineOptions options;
  options.join_start = true;
  const Report report = Refine(world.rig(), ViewsOf(world), start, options);
  for (const CameraReport& camera : report.cameras) {
    ASSERT_TRUE(camera.calibration.covariance) << camera.calibration.StatusText();
    for (int k = 0; k < 6; ++k) EXPECT_LT((*camera.calibration.covariance)(k, k), 3e-7);
  }
}

// Known to be turned about y, be it wrong; not known about x.
TEST(Refine, WhatTheStartKnowsStaysAndWhatItDoesNotIsFound) {
  const SceneWorld& world = Room();
  Calibration start = StartOff(world, 0, 0);
  for (CameraCalibration& camera : start.cameras) {
    camera.camera_from_lidar = RotationAbout(Eigen::Vector3d::UnitY(), 0.2 * kDegree) *
                               RotationAbout(Eigen::Vector3d::UnitX(), 0.8 * kDegree) *
                               camera.camera_from_lidar;
    Vector6d sigma;
    sigma << 1 * kDegree, 1e-5, 1 * kDegree, 1e-3, 1e-3, 1e-3;
    camera.covariance = Matrix6d(sigma.cwiseAbs2().asDiagonal());
  }
  RefineOptions options;
  options.join_start = true;
  const Report report = Refine(world.rig(), ViewsOf(world), start, options);
  for (std::size_t c = 0; c < 2; ++c) {
    const CameraCalibration& found = report.cameras[c].calibration;
    ASSERT_EQ(found.status, SolveStatus::kConverged) << found.detail;
    const Vector6d off = Log(found.camera_from_lidar * world.Truth(c).Inverse());
    EXPECT_NEAR(off[1], 0.2 * kDegree, 0.02 * kDegree);
    EXPECT_LT(std::abs(off[0]), 0.2 * kDegree);
  }
}

TEST(Refine, OneOfTwoSweepsIsLeftOutToJudgeBy) {
  std::vector<View> views = ViewsOf(Room());
  views.resize(2);
  for (View& view : views) view.heldout = false;
  const Report report = Refine(Room().rig(), views, StartOff(Room(), 0.5 * kDegree, 0.01));
  for (const CameraReport& camera : report.cameras) {
    EXPECT_EQ(camera.used, std::vector<std::string>{"0"});
    EXPECT_EQ(camera.heldout, std::vector<std::string>{"1"});
    ASSERT_TRUE(camera.scene && camera.scene->heldout_result);
  }
}

TEST(Refine, SaysThatNothingIsToBeSeen) {
  const SceneWorld& world = Room();
  std::vector<View> views = ViewsOf(world);
  for (View& view : views) {
    for (Image& image : view.images) image.pixels.setTo(100);
  }
  const Report report = Refine(world.rig(), views, StartOff(world, 1 * kDegree, 0.02));
  for (const CameraReport& camera : report.cameras) {
    EXPECT_EQ(camera.calibration.status, SolveStatus::kNotConverged);
    EXPECT_THAT(camera.calibration.detail, HasSubstr("too few of the cloud's depth edges"));
  }
}

TEST(Refine, WithoutAStartThereIsNoPose) {
  const SceneWorld& world = Room();
  Rig rig = world.rig();
  for (CameraSpec& camera : rig.cameras) camera.camera_from_lidar_guess.reset();
  const Report report = Refine(rig, ViewsOf(world), {});
  EXPECT_EQ(report.cameras[0].calibration.status, SolveStatus::kNotSolved);
  EXPECT_THAT(report.cameras[0].calibration.detail, HasSubstr("nothing to start from"));
}

TEST(Refine, AnUnknownMethodIsNamed) {
  RefineOptions options;
  options.method = "magic";
  EXPECT_THROW(Refine(Room().rig(), {}, {}, options), InputError);
}

}  // namespace
}  // namespace rgbdt
