#include "calib/methods/calibrate.h"

#include <algorithm>

#include "calib/methods/paper/by_paper.h"
#include "calib/methods/plane/by_planes.h"
#include "calib/solve/by_boards.h"
#include "calib/solve/camera_views.h"
#include "calib/solve/evaluate.h"

namespace rgbdt {

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
  } else if (options.method == kPlaneMethod) {
    CalibrateByPlanes(rig.target, options, &cameras, &report);
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
