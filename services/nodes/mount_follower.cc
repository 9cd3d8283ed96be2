#include "services/nodes/mount_follower.h"

#include <cmath>
#include <cstdio>

namespace rgbdt {
namespace {

constexpr double kDegreesPerRadian = 180 / M_PI;
// Less is not worth a change.
constexpr double kLeastRad = 0.02 / kDegreesPerRadian, kLeastM = 0.002;

std::string ApartWords(const Rigid3& a, const Rigid3& b) {
  const PoseError apart = ErrorOf(a, b);
  char text[80];
  std::snprintf(text, sizeof(text), "%.2f deg and %.0f mm from its calibration", apart.rotation_deg,
                apart.translation_mm);
  return text;
}

bool IsWithin(const Rigid3& a, const Rigid3& b, double rotation_rad, double translation_m) {
  return RotationDistance(a, b) <= rotation_rad && CentreDistance(a, b) <= translation_m;
}

}  // namespace

bool MountFollower::Take(const CameraCalibration& calibration, Utime utime) {
  Camera& camera = cameras_[calibration.camera];
  const Rigid3 &before = camera.calibration.camera_from_lidar, &now = calibration.camera_from_lidar;
  const bool repeated = camera.utime == utime && before.translation == now.translation &&
                        before.rotation.coeffs() == now.rotation.coeffs() &&
                        camera.calibration.timing == calibration.timing;
  if (repeated && !camera.text.empty()) return false;
  camera = {calibration, utime, now, ""};
  return true;
}

std::optional<MountFollower::Step> MountFollower::Follow(const CameraSpec& spec,
                                                         const MountCheck& check,
                                                         std::string* said) {
  said->clear();
  const auto found = cameras_.find(check.camera);
  if (found == cameras_.end() || found->second.utime != check.calibration_utime) return {};
  Camera& camera = found->second;
  const Rigid3& calibrated = camera.calibration.camera_from_lidar;
  if (check.state == MountState::kHolds) {
    if (camera.text.empty()) return {};
    camera.text.clear();
    camera.used = calibrated;
    *said = check.camera + " holds again: its calibration is used";
    return Step{camera.calibration, camera.utime};
  }
  if (check.state != MountState::kMoved) return {};
  const Rigid3& now = check.camera_from_lidar;
  const std::string apart = ApartWords(now, calibrated);
  if (!IsWithin(now, calibrated, spec.follow.rotation_rad, spec.follow.translation_m)) {
    *said = check.camera + " moved to " + apart + ", farther than the rig file's follow { } lets " +
            "it be followed: calibrate again";
    return {};
  }
  if (!camera.text.empty() && IsWithin(now, camera.used, kLeastRad, kLeastM)) return {};
  camera.used = now;
  camera.text = check.camera + " follows the monitor, " + apart;
  *said = camera.text;
  Step step{camera.calibration, check.utime};
  step.calibration.camera_from_lidar = now;
  step.calibration.covariance = check.covariance;
  return step;
}

std::string MountFollower::Text() const {
  std::string text;
  for (const auto& [name, camera] : cameras_) {
    if (!camera.text.empty()) text += (text.empty() ? "" : "; ") + camera.text;
  }
  return text;
}

}  // namespace rgbdt
