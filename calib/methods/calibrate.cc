#include "calib/methods/calibrate.h"

#include <utility>

#include "calib/methods/bearing_angle/by_bearing_angle.h"
#include "calib/methods/internal/guess_check.h"
#include "calib/methods/internal/lidar_parts.h"
#include "calib/methods/internal/report_parts.h"
#include "calib/methods/line_scan/by_line_scan.h"
#include "calib/methods/paper/by_paper.h"
#include "calib/methods/plane/by_planes.h"
#include "calib/methods/single_shot/by_single_shot.h"
#include "calib/solve/by_boards.h"
#include "calib/solve/camera_views.h"
#include "calib/solve/colouring.h"
#include "calib/solve/evaluate.h"

namespace rgbdt {
namespace {

CameraViews WithGuessChecked(CameraViews camera) {
  const CameraCalibration& found = camera.report.calibration;
  if (!found.converged()) return camera;
  std::string why = WhyGuessIsOff(*camera.spec, found.camera_from_lidar);
  if (!why.empty()) camera.report.warnings.push_back(std::move(why));
  return camera;
}

CalibratedCameras CalibrateCameras(const Target& target, const CalibrateOptions& options,
                                   std::vector<CameraViews> cameras,
                                   std::vector<LidarViews> lidars) {
  if (options.method == kAutoMethod) {
    return CalibrateWithLidars(target, options, std::move(cameras), std::move(lidars));
  }
  const auto by = options.method == kPlaneMethod          ? CalibrateByPlanes
                  : options.method == kLineScanMethod     ? CalibrateByLineScan
                  : options.method == kBearingAngleMethod ? CalibrateByBearingAngle
                                                          : CalibrateBySingleShot;
  return by(target, options, std::move(cameras));
}

}  // namespace

Report Calibrate(const Rig& rig, const std::vector<ViewDetection>& detections,
                 const CalibrateOptions& options) {
  options.Check();
  const CalibrateOptions with_rig = WithRig(options, rig);
  Report report = BlankReport(rig, options.method, detections);
  std::vector<CameraViews> cameras = ViewsOfCameras(rig, detections);
  std::vector<LidarViews> lidars =
      LidarViewsOf(rig, detections, options.first_guess.range_offset_sigma_m);
  if (options.method == kAutoMethod) {
    lidars = WithClouds(std::move(lidars), &cameras);
  } else {
    for (const LidarSpec& lidar : rig.further_lidars) {
      SayNotCalibrated(lidar.name, "only method \"auto\" solves for several LIDARs", &cameras);
    }
  }
  if (options.method == kPaperMethod) {
    for (CameraViews& camera : cameras) camera.report = CalibrateByPaper(options, camera);
  } else {
    CalibratedCameras calibrated =
        CalibrateCameras(rig.target, with_rig, std::move(cameras), std::move(lidars));
    report.lidars = std::move(calibrated.lidars);
    cameras = std::move(calibrated.cameras);
    for (CameraViews& camera : cameras) camera = WithGuessChecked(std::move(camera));
    report.closure = std::move(calibrated.closure);
    report.next_view = std::move(calibrated.next_view);
  }
  for (CameraViews& camera : cameras) AddCamera(std::move(camera), &report);
  return report;
}

namespace {

CameraViews WithCandidatesAt(const Rigid3& camera_from_lidar, CameraViews views) {
  for (CameraView& view : views.all) {
    view = WithChosenCandidate(std::move(view), camera_from_lidar, kJudgeGate);
  }
  return views;
}

// Where image and cloud of views show the board, and none of them where the pose puts it: a pose
// that was written the other way round, in another unit, or of something else. Empty: it is not so.
std::string WhyPoseFitsNowhere(const CameraViews& views, const CameraViews& at_pose,
                               const Rigid3& camera_from_lidar) {
  constexpr std::size_t kLeast = 3;
  const std::size_t seen = views.Usable().size();
  if (seen < kLeast || !at_pose.Usable().empty()) return "";
  const std::size_t inverse = WithCandidatesAt(camera_from_lidar.Inverse(), views).Usable().size();
  std::string why = "In none of " + std::to_string(seen) +
                    " views that show the board is it where this pose puts it. ";
  if (2 * inverse > seen) {
    return why + "In " + std::to_string(inverse) +
           " the inverse does: it seems to be lidar_from_camera. Invert it";
  }
  return why +
         "Check that it is camera_from_lidar (point_in_camera = R * point_in_lidar + t), of this "
         "rig, in metres, its quaternion w x y z";
}

}  // namespace

Report Evaluate(const Rig& rig, const std::vector<ViewDetection>& detections,
                const Calibration& calibration) {
  Report report = BlankReport(rig, calibration.method, detections);
  report.utime = calibration.utime;
  for (const CameraSpec& camera : rig.cameras) {
    const CameraCalibration* found = calibration.Find(camera.name);
    if (found == nullptr) continue;
    const CameraViews all = ViewsOf(camera, detections);
    CameraViews views = WithCandidatesAt(found->camera_from_lidar, all);
    views.report.contradiction = WhyPoseFitsNowhere(all, views, found->camera_from_lidar);
    if (calibration.method == kPaperMethod) {
      views.report.first_guess = camera.camera_from_lidar_guess;
    }
    views.report.calibration = *found;
    if (found->covariance) views.report.sigma = SigmaOf(camera, *found);
    if (found->lens) views = PosedAgain(std::move(views), found->lens->lens, rig.target);
    views.Describe();
    const EdgeModel edges{rig.target, BoardPriors().Means(), {}};
    report.cameras.push_back(JudgeEdges(
        edges, views.Usable(), JudgeCamera(camera, views.Usable(), std::move(views.report))));
  }
  for (const LidarCalibration& lidar : calibration.lidars) {
    report.lidars.push_back(JudgedLidar(lidar, detections));
  }
  return report;
}

}  // namespace rgbdt
