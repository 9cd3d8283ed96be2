#pragma once

#include <array>
#include <optional>

#include "calib/camera/camera.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"

namespace rgbdt {

/// The target's pose from its outline's sides in one image.
struct OutlinePose {
  /// Of each side's curve at its two ends [px^2], with what the board itself is off.
  std::array<Eigen::Matrix2d, 4> side_covariance;
  TargetPose pose;  ///< camera_from_target; half_turn_known is false
  /// Of the sides' misfit, with two degrees of freedom: four lines less a pose.
  double chi2 = 0;
};

/// Least squares over the four sides from a pose nearby: the distance of each side's line from its
/// fitted curve at the curve's two ends [px], with the curve's covariance and `place_sigma_m`, how
/// exactly each end of a side of the board is where its size says. Curves may be parts of the
/// sides. Nothing where a side is not seen, or its curve lies where the lens model ends.
std::optional<OutlinePose> PoseFromSides(const Camera& camera, const Target& target,
                                         const std::array<ImageSide, 4>& sides, const Rigid3& start,
                                         double place_sigma_m);

}  // namespace rgbdt
