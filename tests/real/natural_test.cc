// Refined by the room about the board, which is masked out, from a start that is off, against the
// board's own calibration of the same session. There is no truth.
#include "calib/methods/calibrate.h"
#include "calib/methods/refine.h"
#include "calib/model/linear_algebra.h"
#include "calib/present/report/verdict.h"
#include "tests/figures.h"
#include "tests/real/acfr.h"

namespace rgbdt {
namespace {

constexpr double kMaskedM = 1.0;     // about the board's middle: board, stand, who holds it
constexpr std::size_t kFrames = 10;  // to refine by, those left out to judge by included

void MaskBoards(const ViewDetection& detection, Cloud* cloud) {
  for (const CloudEdges& board : detection.cloud.candidates) {
    const Eigen::Vector3f middle = board.centre.cast<float>();
    for (Eigen::Vector3f& point : cloud->points) {
      // Nearer than all else, and too near to be an edge's own side: no edge arises from it.
      if ((point - middle).norm() < kMaskedM) point = 0.4F * point.normalized();
    }
  }
}

// Converged: as near to the board's own calibration as is asked; otherwise it says why not.
void ComesBack(const std::string& folder) {
  std::vector<View> views;
  const auto detected = DetectReal(kAutoMethod, folder, &views);
  if (!detected) GTEST_SKIP() << "RGBDT_REAL_DATA is not set, or has no " << folder;
  const Rig& rig = detected->session.rig;
  const Report board = Calibrate(rig, detected->views);
  Calibration start = board.ToCalibration();
  ASSERT_EQ(start.cameras.size(), 1U);
  const Rigid3 right = start.cameras[0].camera_from_lidar;
  ASSERT_GE(views.size(), kFrames);
  views.resize(kFrames);
  for (std::size_t v = 0; v < kFrames; ++v) MaskBoards(detected->views[v], &views[v].cloud);
  Vector6d delta;
  delta << Eigen::Vector3d(0.6, -0.6, 0.53) * M_PI / 180, 0.03, -0.03, 0.027;
  start.cameras[0].camera_from_lidar = Exp(delta) * right;
  const Report report = Refine(rig, views, start);
  const CameraCalibration& found = report.cameras[0].calibration;
  const PoseError error = ErrorOf(found.camera_from_lidar, right);
  std::printf("%s: %s; %.2f deg, %.0f mm from the board's own\n", folder.c_str(),
              found.StatusText().c_str(), error.rotation_deg, error.translation_mm);
  const bool told = found.status == SolveStatus::kConverged && report.cameras[0].warnings.empty();
  TellFigure("natural_real_told_" + folder, told ? 1 : 0);
  TellFigure("natural_real_rotation_deg_" + folder, error.rotation_deg, "deg");
  TellFigure("natural_real_translation_mm_" + folder, error.translation_mm, "mm");
  if (told) {
    EXPECT_LT(error.rotation_deg, 0.4);
  } else {
    EXPECT_FALSE(found.detail.empty() && report.cameras[0].warnings.empty());
  }
}

TEST(Natural, TheRoomAboutAVlp16TellsThePoseOrThatItCannot) { ComesBack("acfr_vlp16"); }

TEST(Natural, TheYardAboutAnOusterTellsThePoseOrThatItCannot) { ComesBack("acfr_os64"); }

}  // namespace
}  // namespace rgbdt
