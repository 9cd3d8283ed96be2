#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calib/camera/camera.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"

namespace rgbdt {

/// The target's pose from its inner corners in one image.
struct CornerPose {
  /// camera_from_target with the covariance of delta in the camera's axes (see TargetPose);
  /// half_turn_known is false: corners alone do not tell.
  TargetPose pose;
  double corner_sigma_px = 0;  ///< of a corner along x or y, from the residuals of those used
  /// By how much correlated residuals of neighbouring corners (a lens not quite known, uneven
  /// light) enlarge the pose's sigmas; 1 or more. The covariance has it in.
  double inflation = 1;
  std::vector<bool> used;  ///< for each corner: false is not seen, or off the rest and left out
  /// A plane has a second pose that looks much the same, its tilt mirrored. Sum of squared
  /// residuals of that one minus that of this one, over sigma^2; infinite where there is no such
  /// second pose. Below some 10 the tilt is not certain.
  double second_pose_chi2 = 0;
};

/// Both camera_from_board of a flat board whose points (z = 0 [m], four or more) are seen in these
/// directions, any length, camera axes (Collins and Bartoli 2014, IPPE); none where they cannot be.
std::vector<Rigid3> PlanarPoses(const std::vector<Eigen::Vector3d>& model,
                                const std::vector<Eigen::Vector3d>& directions);

/// Whether inner corners [px], row by row, go right-handed (columns to the right, then rows down),
/// as on a board whose printed side faces the camera. Corners may be NaN where they were not seen.
bool RightHanded(const Target& target, const std::vector<Eigen::Vector2d>& corners);

/// Of the corners that were seen: so large a share may lie off the rest.
inline constexpr double kMostCornersOff = 0.2;

/// Least squares of the reprojection error in pixels of the distorted image, through the whole lens
/// model, from both of the planar pose's solutions (Collins and Bartoli 2014, IPPE); the better one
/// is kept. Robust: Cauchy weights with the residuals' own scale, then corners beyond 4 sigma are
/// left out. `corners`: inner corners [px] in the target's order, NaN where one was not seen; the
/// pose follows from the others. Nothing where no flat board fits: another number of corners, fewer
/// than 4 seen, a mirrored order, corners where the lens model ends, all on one line, or more than
/// `most_off` of them off the rest. `bow_m`: how the board is bent (Target::BowFactors).
std::optional<CornerPose> PoseFromCorners(const Camera& camera, const Target& target,
                                          const std::vector<Eigen::Vector2d>& corners,
                                          double most_off = kMostCornersOff,
                                          const Eigen::Vector3d& bow_m = {0, 0, 0});

/// Why corners that were found are no flat board's, and what to look at: the lens, of which is said
/// what cannot be right.
std::string WhyNoFlatBoard(const Camera& camera);

/// What of the given lens cannot be right, in words; empty: nothing is known against it.
std::string WhyLensIsUnlikely(const Camera& camera);

}  // namespace rgbdt
