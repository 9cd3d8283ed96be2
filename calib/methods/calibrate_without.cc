#include "calib/methods/calibrate_without.h"

#include "calib/model/errors.h"

namespace rgbdt {

Report CalibrateWithout(const Rig& rig, const std::vector<ViewDetection>& detections,
                        const std::set<std::string>& left_out, const CalibrateOptions& options) {
  std::vector<ViewDetection> remaining;
  std::string names;
  for (const ViewDetection& detection : detections) {
    if (left_out.count(detection.view) == 0) {
      remaining.push_back(detection);
    } else {
      names += (names.empty() ? "" : ", ") + detection.view;
    }
  }
  if (remaining.empty()) {
    throw InputError("all views are left out (" + names + "); take one or more back");
  }
  Report report = Calibrate(rig, remaining, options);
  if (names.empty()) return report;
  for (CameraReport& camera : report.cameras) {
    camera.warnings.push_back("Left out by hand: " + names);
  }
  return report;
}

}  // namespace rgbdt
