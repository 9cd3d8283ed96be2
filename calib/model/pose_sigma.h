#pragma once

#include <optional>

#include "calib/model/calibration.h"

namespace rgbdt {

/// 1 sigma of a pose along the axis that is known least: of the rotation [deg] and, by itself, of
/// the camera's centre [mm]. This is the sigma of a pose wherever a person reads one figure.
/// Nothing where the calibration has no covariance, or none that is finite.
std::optional<PoseError> WorstAxisSigma(const CameraCalibration& calibration);

/// The same of a further LIDAR's pose; of its origin in the reference's frame.
std::optional<PoseError> WorstAxisSigma(const LidarCalibration& calibration);

/// Along and about the reference's axes; needs a covariance.
LidarSigma SigmaOf(const LidarCalibration& calibration);

/// From one calibration of a camera to another.
struct PoseChange {
  PoseError difference;
  /// The change of pose in sigmas of `from`: sqrt(delta' covariance^-1 delta). Absent: `from` has
  /// no covariance.
  std::optional<double> sigmas;
};
PoseChange ChangeOf(const CameraCalibration& from, const CameraCalibration& to);

}  // namespace rgbdt
