#include "calib/methods/calibrate.h"
#include "calib/solve/evaluate.h"
#include "tests/unit/solve/solve_world.h"

namespace rgbdt {
namespace {

SolveWorldOptions HalfHeldOut() {
  SolveWorldOptions options;
  options.views = 16;
  options.heldout_every = 2;
  options.draw_nuisances = true;
  options.side_sigma_rad = BoardPriors().side_sigma_rad;
  return options;
}

TEST(EdgeRmsWhitened, IsAboutOneOnViewsHeldOut) {
  const SolveWorld world(HalfHeldOut());
  const Report report = Calibrate(world.rig, world.detections);
  for (const CameraReport& camera : report.cameras) {
    ASSERT_EQ(camera.heldout.size(), 8U);
    EXPECT_NEAR(camera.edge_rms_whitened.heldout.value(), 1, 0.2);
    EXPECT_NEAR(camera.edge_rms_whitened.train.value(), 1, 0.2);
    for (const ViewQuality& view : camera.views) EXPECT_TRUE(view.edge_rms_whitened) << view.view;
  }
}

// Moved by 30 mm towards the camera's right or away from it: sides show the one, the plane the
// other.
TEST(EdgeRmsMm, IsTheDistanceOnTheBoard) {
  SolveWorldOptions options = HalfHeldOut();
  options.draw_nuisances = false;
  const SolveWorld world(options);
  const Calibration right = Calibrate(world.rig, world.detections).ToCalibration();
  const auto moved = [&](const Eigen::Vector3d& by) {
    Calibration calibration = right;
    calibration.cameras[0].camera_from_lidar.translation += by;
    return Evaluate(world.rig, world.detections, calibration).cameras[0];
  };
  const CameraReport still = moved({0, 0, 0});
  const CameraReport aside = moved({0.03, 0, 0});
  const CameraReport away = moved({0, 0, 0.03});
  EXPECT_LT(still.plane_rms_mm.heldout.value(), 15);
  EXPECT_GT(away.plane_rms_mm.heldout.value(), 20);
  EXPECT_LT(away.plane_rms_mm.heldout.value(), 40);
  EXPECT_GT(aside.edge_rms_mm.heldout.value(), still.edge_rms_mm.heldout.value() + 5);
  EXPECT_LT(aside.edge_rms_mm.heldout.value(), 40);
  for (const ViewQuality& view : still.views) {
    EXPECT_TRUE(view.edge_rms_mm && view.plane_rms_mm) << view.view;
  }
}

TEST(EdgeRmsWhitened, GrowsWhereTheCalibrationIsWrong) {
  SolveWorldOptions options = HalfHeldOut();
  options.draw_nuisances = false;
  const SolveWorld world(options);
  Calibration calibration = Calibrate(world.rig, world.detections).ToCalibration();
  const auto heldout = [&](std::size_t camera) {
    return *Evaluate(world.rig, world.detections, calibration)
                .cameras[camera]
                .edge_rms_whitened.heldout;
  };
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_NEAR(heldout(c), 1, 0.2);
    Rigid3& pose = calibration.cameras[c].camera_from_lidar;
    pose = RotationAbout({1, 1, 0}, 0.5 * M_PI / 180) * pose;
    EXPECT_GT(heldout(c), 2);
  }
}

TEST(MisfitOfEdges, OfAViewWithoutPosesOrSigmasThereIsNone) {
  SolveWorld world;
  const CameraCalibration truth{"rgb", world.camera_from_lidar[0], {}, SolveStatus::kConverged, ""};
  const EdgeModel model{world.rig.target};
  CameraView view = CameraViewOf("rgb", world.detections[0]);
  EXPECT_EQ(MisfitOfEdges(model, view, truth).count,
            static_cast<double>(view.cloud->crossings.size()));
  view.cloud->crossings[0].sigma_m = 0;
  EXPECT_EQ(MisfitOfEdges(model, view, truth).count,
            static_cast<double>(view.cloud->crossings.size()) - 1);
  world.ImageAt(0, 0).pose.reset();
  EXPECT_EQ(MisfitOfEdges(model, view, truth).count, 0);
}

}  // namespace
}  // namespace rgbdt
