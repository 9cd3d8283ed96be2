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
  const Report report = Calibrate(world.rig, world.observations);
  for (const CameraReport& camera : report.cameras) {
    ASSERT_EQ(camera.heldout.size(), 8U);
    EXPECT_NEAR(camera.edge_rms_whitened.heldout.value(), 1, 0.2);
    EXPECT_NEAR(camera.edge_rms_whitened.train.value(), 1, 0.2);
    for (const ViewQuality& view : camera.views) EXPECT_TRUE(view.edge_rms_whitened) << view.view;
  }
}

TEST(EdgeRmsWhitened, GrowsWhereTheCalibrationIsWrong) {
  SolveWorldOptions options = HalfHeldOut();
  options.draw_nuisances = false;
  const SolveWorld world(options);
  Calibration calibration = Calibrate(world.rig, world.observations).ToCalibration();
  const auto heldout = [&](std::size_t camera) {
    return *Evaluate(world.rig, world.observations, calibration)
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
  Observation o = world.At(0, 0);
  EXPECT_EQ(MisfitOfEdges(model, o, truth).count, static_cast<double>(o.cloud->crossings.size()));
  o.cloud->crossings[0].sigma_m = 0;
  EXPECT_EQ(MisfitOfEdges(model, o, truth).count,
            static_cast<double>(o.cloud->crossings.size()) - 1);
  o.image->pose.reset();
  EXPECT_EQ(MisfitOfEdges(model, o, truth).count, 0);
}

}  // namespace
}  // namespace rgbdt
