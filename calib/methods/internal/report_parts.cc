#include "calib/methods/internal/report_parts.h"

#include <algorithm>
#include <utility>

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

Report BlankReport(const Rig& rig, const std::string& method,
                   const std::vector<ViewDetection>& detections) {
  Report report;
  report.method = method;
  report.rig_hash = rig.hash;
  report.detections = SummariesOf(detections);
  return report;
}

std::vector<CameraViews> ViewsOfCameras(const Rig& rig,
                                        const std::vector<ViewDetection>& detections) {
  std::vector<CameraViews> cameras;
  for (const CameraSpec& camera : rig.cameras) cameras.push_back(ViewsOf(camera, detections));
  return cameras;
}

void AddCamera(CameraViews camera, Report* report) {
  camera.Describe();
  for (const CameraView* view : camera.Usable()) {
    report->utime = std::max(report->utime, view->image_utime);
  }
  report->cameras.push_back(std::move(camera.report));
}

CalibrateOptions WithRig(CalibrateOptions options, const Rig& rig) {
  if (!(options.first_guess.range_offset_sigma_m > 0)) {
    options.first_guess.range_offset_sigma_m = rig.lidar.range_offset_sigma_m;
  }
  return options;
}

}  // namespace rgbdt
