#include "calib/solve/calibrate.h"

#include <algorithm>

#include "calib/model/errors.h"
#include "calib/solve/by_boards.h"
#include "calib/solve/by_paper.h"
#include "calib/solve/camera_views.h"
#include "calib/solve/evaluate.h"

namespace rgbdt {

void CalibrateOptions::Check() const {
  RequireMethod(method);
  first_guess.Check();
  const auto at_least = [](int value, int least, const char* name) {
    if (value < least) {
      throw InputError(std::string("CalibrateOptions.") + name + " is " + std::to_string(value) +
                       "; expected " + std::to_string(least) + " or more");
    }
  };
  at_least(min_views, 1, "min_views");
  at_least(max_iterations, 1, "max_iterations");
  at_least(folds, 2, "folds");
}

std::string TooFewViews(std::size_t usable, const CalibrateOptions& options) {
  return "not calibrated: " + std::to_string(usable) + " usable views, at least " +
         std::to_string(options.min_views) + " are needed";
}

Report Calibrate(const Rig& rig, const std::vector<Observation>& observations,
                 const CalibrateOptions& options) {
  options.Check();
  Report report;
  report.method = options.method;
  report.rig_hash = rig.hash;
  std::vector<CameraViews> cameras;
  for (const CameraSpec& camera : rig.cameras) cameras.push_back(ViewsOf(camera, observations));
  if (options.method == kPaperMethod) {
    for (CameraViews& camera : cameras) CalibrateByPaper(options, &camera);
  } else {
    CalibrateByBoards(rig.target, options, &cameras, &report);
  }
  for (CameraViews& camera : cameras) {
    camera.Describe();
    for (const Observation* o : camera.Usable()) {
      report.utime = std::max(report.utime, o->image_utime);
    }
    report.cameras.push_back(std::move(camera.report));
  }
  return report;
}

Report Evaluate(const Rig& rig, const std::vector<Observation>& observations,
                const Calibration& calibration) {
  Report report;
  report.method = calibration.method;
  report.rig_hash = rig.hash;
  report.utime = calibration.utime;
  for (const CameraSpec& camera : rig.cameras) {
    const CameraCalibration* found = calibration.Find(camera.name);
    if (found == nullptr) continue;
    CameraViews views = ViewsOf(camera, observations);
    for (Observation& o : views.all) {
      o = WithChosenCandidate(std::move(o), found->camera_from_lidar, kJudgeGate);
    }
    if (calibration.method == kPaperMethod) {
      views.report.first_guess = camera.camera_from_lidar_guess;
    }
    views.report.calibration = *found;
    views.Describe();
    JudgeCamera(camera, views.Usable(), &views.report);
    JudgeEdges(EdgeModel{rig.target, BoardPriors().Means(), {}}, views.Usable(), &views.report);
    report.cameras.push_back(std::move(views.report));
  }
  return report;
}

}  // namespace rgbdt
