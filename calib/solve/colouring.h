#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calib/camera/camera.h"
#include "calib/model/calibration.h"
#include "calib/model/rig.h"
#include "calib/model/rigid3.h"

namespace rgbdt {

/// Distances [m] from the camera of the points whose reprojection uncertainty PoseSigma gives.
inline constexpr double kColouringDistancesM[] = {2, 5, 10, 50};

/// Pixels all over an image, its border among them: what is worst anywhere in it is at one of them.
std::vector<Eigen::Vector2d> ImageGrid(const Camera& camera);

/// What a calibration's covariance means in degrees, millimetres and pixels; it must have one.
/// centre_mm is in the LIDAR's axes: the centre lies at -R^T t, so that delta's translation moves
/// it by -R^T (tx, ty, tz) to first order, and its rotation not at all. A number that is not to be
/// had is NaN: centre_px where the lens model ends before the image's middle.
PoseSigma SigmaOf(const CameraSpec& spec, const CameraCalibration& calibration);

/// The square of ColouringSigmaAt [px^2] at any distance d [m] from the camera:
/// lasting + per_m / d + per_m2 / d^2. The pose's rotation and the lens move a pixel alike however
/// far the point is, its translation moves it by the inverse of the distance.
struct ColouringVariance {
  double lasting = 0, per_m = 0, per_m2 = 0;

  double SigmaAt(double distance_m) const;
};

/// Of the pixel's point at any distance; nothing where no direction maps to the pixel.
std::optional<ColouringVariance> ColouringVarianceOf(const Camera& camera,
                                                     const PoseAndLensCovariance& covariance,
                                                     const Eigen::Vector2d& pixel);

/// Of those pixels of the image that are worst at some distance from 0.3 to 300 m: the largest of
/// their sigmas at a distance is PoseSigma's `worst_px` there.
std::vector<ColouringVariance> WorstColouring(const CameraSpec& spec,
                                              const CameraCalibration& calibration);

/// 1 sigma [px], of pose and lens, of where the colour of a point is taken from, the point being
/// where `pixel` looks, `distance_m` from the camera. It is the RMS length of the displacement, the
/// root of the trace of the pixel's covariance: never less than the sigma along any one direction
/// in the image, at most 1.41 times the largest of them. Nothing where no direction maps to the
/// pixel.
std::optional<double> ColouringSigmaAt(const Camera& camera,
                                       const PoseAndLensCovariance& covariance,
                                       const Eigen::Vector2d& pixel, double distance_m);

}  // namespace rgbdt
