#include "calib/methods/bearing_angle/by_bearing_angle.h"

#include <algorithm>
#include <cmath>

#include "calib/camera/camera.h"
#include "calib/methods/bearing_angle/angle_pose.h"
#include "calib/methods/calibrate.h"
#include "tests/unit/solve/solve_world.h"

namespace rgbdt {
namespace {

using testing::HasSubstr;

SolveWorldOptions ExactCorners() {
  SolveWorldOptions options;
  options.noise = 0;
  return options;
}

// The true corners in both pictures.
std::vector<CornerPick> TruePicks(const SolveWorld& world, std::size_t camera) {
  std::vector<CornerPick> picks;
  const Camera lens(world.rig.cameras[camera]);
  for (const Rigid3& board : world.lidar_from_target) {
    for (const Eigen::Vector3d& corner : world.rig.target.OutlineCorners()) {
      const Eigen::Vector3d point = board * corner;
      picks.push_back({point, *lens.Project(world.camera_from_lidar[camera] * point), 0.03});
    }
  }
  return picks;
}

TEST(PoseFromAngles, IsExactWhereverTheCameraIs) {
  Random random(5);
  for (int trial = 0; trial < 20; ++trial) {
    const Rigid3 camera_from_lidar = random.Pose();
    std::vector<Eigen::Vector3d> points;
    std::vector<Eigen::Vector3d> directions;
    for (int i = 0; i < 8; ++i) {
      const Eigen::Vector3d in_camera(random.Uniform(-2, 2), random.Uniform(-2, 2),
                                      random.Uniform(2, 6));
      points.push_back(camera_from_lidar.Inverse() * in_camera);
      directions.push_back(in_camera.normalized());
    }
    const auto pose = PoseFromAngles(points, directions);
    ASSERT_TRUE(pose.has_value()) << trial;
    EXPECT_THAT(*pose, Rigid3Near(camera_from_lidar, 1e-4, 1e-4)) << trial;
  }
}

TEST(SolveCornerPicks, RecoversThePoseExactlyWithoutAGuess) {
  const SolveWorld world(ExactCorners());
  for (std::size_t c = 0; c < 2; ++c) {
    const auto result = SolveCornerPicks(world.rig.cameras[c], TruePicks(world, c));
    EXPECT_EQ(result.status, SolveStatus::kConverged) << result.detail;
    EXPECT_THAT(result.camera_from_lidar, Rigid3Near(world.camera_from_lidar[c], 1e-7, 1e-7));
  }
}

TEST(SolveCornerPicks, ItsCovarianceIsTheUsualOne) {
  constexpr int kSessions = 60;
  SolveWorld world(ExactCorners());
  const std::vector<CornerPick> exact = TruePicks(world, 0);
  double chi2 = 0;
  for (int session = 0; session < kSessions; ++session) {
    std::vector<CornerPick> picks = exact;
    for (CornerPick& pick : picks) {
      pick.pixel += 1.5 * Eigen::Vector2d(world.Normal(), world.Normal());
    }
    const auto result = SolveCornerPicks(world.rig.cameras[0], picks);
    ASSERT_TRUE(result.covariance) << result.detail;
    chi2 += Chi2Of(world.camera_from_lidar[0], result.camera_from_lidar, *result.covariance) /
            kSessions;
  }
  // Of six degrees of freedom; 4 of its own sigma of sqrt(12 / 60).
  EXPECT_NEAR(chi2, 6, 1.8);
}

TEST(SolveCornerPicks, FewAreTooFew) {
  const SolveWorld world(ExactCorners());
  std::vector<CornerPick> picks = TruePicks(world, 0);
  picks.resize(7);
  const auto result = SolveCornerPicks(world.rig.cameras[0], picks);
  EXPECT_EQ(result.status, SolveStatus::kNotSolved);
  EXPECT_THAT(result.detail, HasSubstr("8 are needed"));
}

TEST(SolveCornerPicks, WrongPairsAreNoCalibration) {
  const SolveWorld world(ExactCorners());
  std::vector<CornerPick> picks = TruePicks(world, 0);
  for (std::size_t i = 0; i + 1 < picks.size(); ++i) picks[i].pixel = picks[i + 1].pixel;
  EXPECT_FALSE(SolveCornerPicks(world.rig.cameras[0], picks).converged());
}

TEST(CalibrateByBearingAngle, PairsCornersOfCloudsToldFromEitherEnd) {
  SolveWorld world(ExactCorners());
  for (std::size_t v = 0; v < world.lidar_from_target.size(); ++v) {
    const auto corners = world.rig.target.OutlineCorners();
    const std::size_t turned = v % 2 == 1 ? 2 : 0;  // as SolveWorld tells clouds
    for (std::size_t k = 0; k < 4; ++k) {
      world.CloudAt(v).corners.emplace_back(world.lidar_from_target[v] * corners[(k + turned) % 4]);
    }
  }
  CalibrateOptions options;
  options.method = kBearingAngleMethod;
  const Report report = Calibrate(world.rig, world.detections, options);
  for (std::size_t c = 0; c < 2; ++c) {
    const CameraCalibration& found = report.cameras[c].calibration;
    EXPECT_TRUE(found.converged()) << found.StatusText();
    EXPECT_THAT(found.camera_from_lidar, Rigid3Near(world.camera_from_lidar[c], 1e-7, 1e-7));
  }
}

}  // namespace
}  // namespace rgbdt
