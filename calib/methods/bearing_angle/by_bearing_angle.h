#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/rig.h"
#include "calib/solve/camera_views.h"
#include "calib/solve/guess_cameras.h"
#include "calib/solve/options.h"

namespace rgbdt {

// What the paper leaves open, and what stands here. Correspondences: board_corners.h; in the image
// the board's outline, which is fitted, or picked by a person (view.textproto) and then fitted.
// Which corner is which follows from the first guess of the boards' poses (first_guess.h); that
// guess has no other say. The refinement is of squared pixels, all alike. When a result is no
// calibration is ours: the paper does not say.

struct BearingAngleOptions {
  std::size_t least_points = 8;  ///< correspondences
  std::size_t most_linear = 60;  ///< of them, evenly, in the linear pose: its time goes cubed
  /// RMS distance beyond: not converged, [beams' spacings on the boards]. Picks are up to one off.
  double most_spacings = 2;

  /// Throws InputError naming the field and its value.
  void Check() const;
};

/// A point that was picked in both pictures.
struct CornerPick {
  Eigen::Vector3d point{0, 0, 0};  ///< LIDAR frame [m]
  Eigen::Vector2d pixel{0, 0};
  double spacing_m = 0;  ///< between beams there
};

/// All corners that image and cloud of used views have in common.
std::vector<CornerPick> CornerPicks(const std::vector<const CameraView*>& used,
                                    const Rigid3& guess);

/// Scaramuzza, Harati and Siegwart, Extrinsic self calibration of a camera and a 3D laser range
/// finder from natural scenes, IROS 2007: the pose from points and directions without a guess
/// (angle_pose.h), then least squares of the distances in the image. The covariance is the usual
/// one, by the residuals. Not solved: too few correspondences, or no linear pose from them. Not
/// converged: residuals far above a beam's spacing.
CameraCalibration SolveCornerPicks(const CameraSpec& spec, const std::vector<CornerPick>& picks,
                                   const BearingAngleOptions& options = {});

/// "bearing-angle": see Calibrate.
CalibratedCameras CalibrateByBearingAngle(const Target& target, const CalibrateOptions& options,
                                          std::vector<CameraViews> cameras);

}  // namespace rgbdt
