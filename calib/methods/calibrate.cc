#include "calib/methods/calibrate.h"

#include <algorithm>
#include <utility>

#include "calib/methods/paper/by_paper.h"
#include "calib/methods/plane/by_planes.h"
#include "calib/solve/by_boards.h"
#include "calib/solve/camera_views.h"
#include "calib/solve/evaluate.h"

namespace rgbdt {
namespace {

std::vector<DetectedView> SummariesOf(const std::vector<ViewDetection>& detections) {
  std::vector<DetectedView> summaries;
  for (const ViewDetection& detection : detections) {
    DetectedView& summary = summaries.emplace_back();
    summary.view = detection.view;
    summary.heldout = detection.heldout;
    for (const ImageDetection& image : detection.images) {
      summary.images.push_back({image.camera, image.why_not});
    }
    summary.cloud_candidates = static_cast<int>(detection.cloud.candidates.size());
    summary.cloud_why_not = detection.cloud.why_not;
  }
  return summaries;
}

}  // namespace

Report Calibrate(const Rig& rig, const std::vector<ViewDetection>& detections,
                 const CalibrateOptions& options) {
  options.Check();
  CalibrateOptions with_rig = options;
  if (!(options.first_guess.range_offset_sigma_m > 0)) {
    with_rig.first_guess.range_offset_sigma_m = rig.lidar.range_offset_sigma_m;
  }
  Report report;
  report.method = options.method;
  report.rig_hash = rig.hash;
  report.detections = SummariesOf(detections);
  std::vector<CameraViews> cameras;
  for (const CameraSpec& camera : rig.cameras) cameras.push_back(ViewsOf(camera, detections));
  if (options.method == kPaperMethod) {
    for (CameraViews& camera : cameras) camera.report = CalibrateByPaper(options, camera);
  } else {
    CalibratedCameras calibrated =
        options.method == kPlaneMethod
            ? CalibrateByPlanes(rig.target, with_rig, std::move(cameras))
            : CalibrateByBoards(rig.target, with_rig, std::move(cameras));
    cameras = std::move(calibrated.cameras);
    report.closure = std::move(calibrated.closure);
    report.next_view = std::move(calibrated.next_view);
  }
  for (CameraViews& camera : cameras) {
    camera.Describe();
    for (const CameraView* view : camera.Usable()) {
      report.utime = std::max(report.utime, view->image_utime);
    }
    report.cameras.push_back(std::move(camera.report));
  }
  return report;
}

Report Evaluate(const Rig& rig, const std::vector<ViewDetection>& detections,
                const Calibration& calibration) {
  Report report;
  report.method = calibration.method;
  report.rig_hash = rig.hash;
  report.detections = SummariesOf(detections);
  report.utime = calibration.utime;
  for (const CameraSpec& camera : rig.cameras) {
    const CameraCalibration* found = calibration.Find(camera.name);
    if (found == nullptr) continue;
    CameraViews views = ViewsOf(camera, detections);
    for (CameraView& view : views.all) {
      view = WithChosenCandidate(std::move(view), found->camera_from_lidar, kJudgeGate);
    }
    if (calibration.method == kPaperMethod) {
      views.report.first_guess = camera.camera_from_lidar_guess;
    }
    views.report.calibration = *found;
    if (found->lens) views = PosedAgain(std::move(views), found->lens->lens, rig.target);
    views.Describe();
    const EdgeModel edges{rig.target, BoardPriors().Means(), {}};
    report.cameras.push_back(JudgeEdges(
        edges, views.Usable(), JudgeCamera(camera, views.Usable(), std::move(views.report))));
  }
  return report;
}

}  // namespace rgbdt
