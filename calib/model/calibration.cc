#include "calib/model/calibration.h"

namespace rgbdt {

Calibration Report::ToCalibration() const {
  Calibration calibration{method, rig_hash, utime, {}};
  for (const CameraReport& camera : cameras) {
    if (camera.solved()) calibration.cameras.push_back(camera.calibration);
  }
  return calibration;
}

PoseError ErrorOf(const Rigid3& estimate, const Rigid3& truth) {
  return {RotationDistance(estimate, truth) * 180.0 / M_PI,
          CentreDistance(estimate, truth) * 1000.0};
}

void AddTruth(const Truth& truth, Report* report) {
  for (CameraReport& camera : report->cameras) {
    const auto found = truth.camera_from_lidar.find(camera.calibration.camera);
    if (found == truth.camera_from_lidar.end()) continue;
    if (camera.first_guess) {
      camera.first_guess_error = ErrorOf(*camera.first_guess, found->second);
    }
    camera.truth_error = ErrorOf(camera.calibration.camera_from_lidar, found->second);
    for (StartResult& start : camera.other_starts) {
      start.truth_error = ErrorOf(start.calibration.camera_from_lidar, found->second);
    }
  }
}

}  // namespace rgbdt
