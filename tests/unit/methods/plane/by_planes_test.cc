#include "calib/methods/plane/by_planes.h"

#include "calib/methods/calibrate.h"
#include "tests/unit/solve/solve_world.h"

namespace rgbdt {
namespace {

CameraCalibration SolveCamera(const SolveWorld& world, std::size_t camera, const Rigid3& start) {
  return SolvePlanes(ViewsOf(world.rig.cameras[camera], world.detections).Usable(), start);
}

SolveWorldOptions Exact() {
  SolveWorldOptions options;
  options.noise = 0;
  return options;
}

TEST(SolvePlanes, RecoversThePoseExactlyFromDegreesOff) {
  const SolveWorld world(Exact());
  for (std::size_t c = 0; c < 2; ++c) {
    const Rigid3 start = GuessOff(world.camera_from_lidar[c], 0.05, 0.05, 3);
    const CameraCalibration result = SolveCamera(world, c, start);
    EXPECT_EQ(result.status, SolveStatus::kConverged);
    EXPECT_THAT(result.camera_from_lidar, Rigid3Near(world.camera_from_lidar[c], 1e-8, 1e-8));
  }
}

TEST(SolvePlanes, EdgesHaveNoSay) {
  SolveWorld world;
  const auto solve = [&] {
    return SolveCamera(world, 0, world.camera_from_lidar[0]).camera_from_lidar;
  };
  const Rigid3 with = solve();
  for (std::size_t v = 0; v < world.lidar_from_target.size(); ++v) {
    world.CloudAt(v).crossings.clear();
  }
  EXPECT_THAT(solve(), Rigid3Near(with, 0, 0));
}

TEST(SolvePlanes, ItsCovarianceIsTheUsualOne) {
  // Images without noise: the planes are exact, as it takes them to be.
  double chi2 = 0;
  constexpr int kSessions = 100;
  for (std::uint32_t seed = 0; seed < kSessions; ++seed) {
    SolveWorldOptions options;
    options.seed = 500 + seed;
    options.views = 8;
    SolveWorld world(options);
    for (std::size_t v = 0; v < 8; ++v) {
      world.ImageAt(v, 0).pose->sensor_from_target =
          world.camera_from_lidar[0] * world.lidar_from_target[v];
    }
    const CameraCalibration result = SolveCamera(world, 0, world.camera_from_lidar[0]);
    ASSERT_TRUE(result.covariance);
    chi2 += Chi2Of(world.camera_from_lidar[0], result.camera_from_lidar, *result.covariance) /
            kSessions;
  }
  // Its own sigma is 0.35. Noise lies along the beams, distances along the normal: a little more.
  EXPECT_GT(chi2, 5);
  EXPECT_LT(chi2, 7.5);
}

TEST(SolvePlanes, ParallelBoardsAreDegenerate) {
  SolveWorldOptions options = Exact();
  options.views = 0;
  SolveWorld world(options);
  Rigid3 board = world.AnyBoard();
  for (int i = 0; i < 6; ++i) {
    board.translation = (1 + 0.1 * i) * board.translation;
    world.AddView(board);
  }
  const CameraCalibration result = SolveCamera(world, 0, world.camera_from_lidar[0]);
  EXPECT_EQ(result.status, SolveStatus::kDegenerate);
  EXPECT_FALSE(result.covariance);
}

TEST(CalibrateByPlanes, SolvesEachCameraByItself) {
  SolveWorldOptions world_options;
  world_options.views = 15;
  const SolveWorld world(world_options);
  CalibrateOptions options;
  options.method = kPlaneMethod;
  const Report report = Calibrate(world.rig, world.detections, options);
  EXPECT_EQ(report.method, kPlaneMethod);
  for (std::size_t c = 0; c < 2; ++c) {
    const CameraReport& camera = report.cameras[c];
    EXPECT_TRUE(camera.calibration.converged()) << camera.calibration.StatusText();
    const CameraCalibration alone = SolveCamera(world, c, world.camera_from_lidar[c]);
    EXPECT_THAT(camera.calibration.camera_from_lidar,
                Rigid3Near(alone.camera_from_lidar, 1e-7, 1e-7));
    EXPECT_THAT(camera.calibration.camera_from_lidar,
                Rigid3Near(world.camera_from_lidar[c], 0.01, 0.03));
    EXPECT_TRUE(camera.sigma);
    EXPECT_TRUE(camera.folds.empty());
  }
}

}  // namespace
}  // namespace rgbdt
