#include "calib/methods/calibrate_by_views.h"

#include <set>

#include "calib/model/method.h"
#include "calib/model/text.h"

namespace rgbdt {

std::vector<Report> CalibrateByViews(const Rig& rig, const std::vector<ViewDetection>& detections,
                                     const Report& report) {
  std::vector<Report> reports;
  CalibrateOptions options;
  options.diagnostics = false;
  std::set<std::string, decltype(&NaturalLess)> used(&NaturalLess);
  for (const CameraReport& camera : report.cameras) {
    used.insert(camera.used.begin(), camera.used.end());
  }
  std::vector<ViewDetection> so_far;
  for (const std::string& view : used) {
    if (report.method != kAutoMethod || view == *used.rbegin()) break;
    for (const ViewDetection& detection : detections) {
      if (detection.view == view) so_far.push_back(detection);
    }
    reports.push_back(Calibrate(rig, so_far, options));
  }
  reports.push_back(report);
  return reports;
}

}  // namespace rgbdt
