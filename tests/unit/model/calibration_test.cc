#include "calib/model/calibration.h"

#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

// A camera in the LIDAR frame at `centre`, turned by `angle` about the LIDAR's z.
Rigid3 CameraAt(const Eigen::Vector3d& centre, double angle) {
  Rigid3 lidar_from_camera = RotationAbout({0, 0, 1}, angle);
  lidar_from_camera.translation = centre;
  return lidar_from_camera.Inverse();
}

TEST(ErrorOf, IsInDegreesAndMillimetresBetweenCentres) {
  const PoseError error = ErrorOf(CameraAt({0, 0, 0.1}, 0), CameraAt({0, 0.03, 0.06}, 0.5));
  EXPECT_NEAR(error.rotation_deg, 0.5 * 180 / M_PI, 1e-10);
  EXPECT_NEAR(error.translation_mm, 50, 1e-10);  // 30 and 40
}

TEST(WithTruth, FillsEveryErrorThatNeedsTruth) {
  Report report;
  report.cameras.resize(2);
  CameraReport& rgb = report.cameras[0];
  rgb.calibration.camera = "rgb";
  rgb.calibration.camera_from_lidar = CameraAt({0.01, 0, 0}, 0);
  rgb.first_guess = CameraAt({0.05, 0, 0}, 0);
  rgb.other_starts.resize(1);
  rgb.other_starts[0].calibration.camera_from_lidar = CameraAt({0.2, 0, 0}, 0);
  report.cameras[1].calibration.camera = "thermal";
  const Report judged = WithTruth(report, {{{"rgb", CameraAt({0, 0, 0}, 0)}}, {}});
  const CameraReport& known = judged.cameras[0];

  ASSERT_TRUE(known.truth_error && known.first_guess_error && known.other_starts[0].truth_error);
  EXPECT_NEAR(known.truth_error->translation_mm, 10, 1e-10);
  EXPECT_NEAR(known.first_guess_error->translation_mm, 50, 1e-10);
  EXPECT_NEAR(known.other_starts[0].truth_error->translation_mm, 200, 1e-10);
  // What is unknown is absent, not zero.
  EXPECT_FALSE(judged.cameras[1].truth_error);
  EXPECT_FALSE(judged.cameras[1].first_guess_error);
}

TEST(Report, ToCalibrationKeepsTheSolvedCamerasAndWhereItComesFrom) {
  Report report;
  report.method = "paper";
  report.rig_hash = "abc";
  report.utime = 42;
  report.cameras.resize(3);
  report.cameras[0].calibration.camera = "rgb";
  report.cameras[0].calibration.status = SolveStatus::kConverged;
  report.cameras[1].calibration.camera = "thermal";
  report.cameras[1].calibration.status = SolveStatus::kNotConverged;
  report.cameras[2].calibration.camera = "lwir";
  report.cameras[2].calibration.detail = "0 usable views";
  const Calibration calibration = report.ToCalibration();
  EXPECT_EQ(calibration.method, "paper");
  EXPECT_EQ(calibration.rig_hash, "abc");
  EXPECT_EQ(calibration.utime, 42);
  ASSERT_EQ(calibration.cameras.size(), 2U);
  ASSERT_NE(calibration.Find("thermal"), nullptr);
  EXPECT_EQ(calibration.Find("thermal")->status, SolveStatus::kNotConverged);
  EXPECT_EQ(calibration.Find("lwir"), nullptr) << "a guess is no calibration";
}

TEST(CameraCalibration, SaysHowItsSolveEnded) {
  CameraCalibration calibration;
  EXPECT_EQ(calibration.StatusText(), "not calibrated");
  EXPECT_FALSE(calibration.solved());
  calibration.detail = "the reason";
  const std::map<SolveStatus, std::string> texts = {
      {SolveStatus::kNotSolved, "not calibrated: the reason"},
      {SolveStatus::kUndetermined, "degenerate: the reason"},
      {SolveStatus::kNotConverged, "not converged: the reason"},
      {SolveStatus::kDegenerate, "degenerate: the reason"},
      {SolveStatus::kFirstGuessKept, "converged; the first guess was kept: the reason"},
      {SolveStatus::kConverged, "converged: the reason"}};
  for (const auto& [status, text] : texts) {
    calibration.status = status;
    EXPECT_EQ(calibration.StatusText(), text);
    EXPECT_EQ(calibration.solved(), status >= SolveStatus::kNotConverged) << text;
    EXPECT_EQ(calibration.converged(), status >= SolveStatus::kFirstGuessKept) << text;
  }
}

}  // namespace
}  // namespace rgbdt
