#include "calib/methods/internal/guess_check.h"

#include <cmath>

#include "calib/model/calibration.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

// Beyond what the 2015 paper's guesses were off by (its Figure 6: 30 and 40 deg).
constexpr double kFarDeg = 45, kFarMm = 500;
constexpr double kNearDeg = 20, kNearMm = 300;

bool IsFar(const PoseError& off) {
  return off.rotation_deg > kFarDeg || off.translation_mm > kFarMm;
}

}  // namespace

std::string WhyGuessIsOff(const CameraSpec& camera, const Rigid3& camera_from_lidar) {
  if (!camera.camera_from_lidar_guess) return "";
  const Rigid3& guess = *camera.camera_from_lidar_guess;
  const PoseError off = ErrorOf(guess, camera_from_lidar);
  if (!IsFar(off)) return "";
  const std::string far = Format(
      "camera_from_lidar_guess of %s in the rig file lies %.0f deg and %.0f mm from the result",
      camera.name.c_str(), off.rotation_deg, off.translation_mm);
  const PoseError inverted = ErrorOf(guess.Inverse(), camera_from_lidar);
  if (inverted.rotation_deg < kNearDeg && inverted.translation_mm < kNearMm) {
    return far + Format(
                     "; its inverse only %.0f deg and %.0f mm: it seems to be lidar_from_camera. "
                     "Write its inverse",
                     inverted.rotation_deg, inverted.translation_mm);
  }
  return far + ". It was not used for it; measure it anew, or leave it out";
}

}  // namespace rgbdt
