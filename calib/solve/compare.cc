#include "calib/solve/compare.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/camera/camera.h"
#include "calib/model/linear_algebra.h"
#include "calib/solve/colouring.h"

namespace rgbdt {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kDegrees = 180 / M_PI;
constexpr double kDistancesM[] = {2, 5, 10};

std::optional<Matrix6d> CovarianceOfDifference(const CameraCalibration& a,
                                               const CameraCalibration& b, const Rigid3& b_from_a) {
  if (!a.converged() || !b.converged() || !a.covariance || !b.covariance) return std::nullopt;
  const Matrix6d adjoint = Adjoint(b_from_a);
  return Matrix6d(*b.covariance + adjoint * *a.covariance * adjoint.transpose());
}

// Of the camera's centre, LIDAR axes (colouring.h).
Eigen::Matrix3d CentreCovariance(const CameraCalibration& calibration) {
  const Eigen::Matrix3d r = calibration.camera_from_lidar.rotation.toRotationMatrix();
  return r.transpose() * calibration.covariance->bottomRightCorner<3, 3>() * r;
}

std::array<Estimate, 3> Estimates(const Eigen::Vector3d& values,
                                  const std::optional<Eigen::Matrix3d>& covariance, double scale) {
  std::array<Estimate, 3> out;
  for (int k = 0; k < 3; ++k) {
    const double sigma = covariance ? std::sqrt(std::max(0.0, (*covariance)(k, k))) : kNan;
    out[static_cast<std::size_t>(k)] = {scale * values[k], scale * sigma};
  }
  return out;
}

// A point that looks at `pixel` by pose a, seen by pose b, lies at b_from_a * point.
PixelShift ShiftAt(const Camera& camera, const Rigid3& b_from_a,
                   const std::optional<Matrix6d>& covariance, double distance_m) {
  PixelShift shift;
  shift.distance_m = distance_m;
  double squares = 0;
  double variances = 0;
  int count = 0;
  for (const Eigen::Vector2d& pixel : ImageGrid(camera)) {
    const auto direction = camera.Unproject(pixel);
    if (!direction) continue;
    const auto moved = camera.Project(b_from_a * Eigen::Vector3d(distance_m * *direction));
    if (!moved) continue;
    squares += (*moved - pixel).squaredNorm();
    ++count;
    if (!covariance) continue;
    const double sigma = ColouringSigmaAt(camera, *covariance, pixel, distance_m).value_or(kNan);
    variances += sigma * sigma;
  }
  shift.rms_px = count > 0 ? std::sqrt(squares / count) : kNan;
  if (covariance && count > 0) shift.sigma_px = std::sqrt(variances / count);
  return shift;
}

}  // namespace

PoseComparison Compare(const CameraCalibration& a, const CameraCalibration& b,
                       const CameraSpec* spec) {
  const Rigid3 b_from_a = b.camera_from_lidar * a.camera_from_lidar.Inverse();
  const Vector6d delta = Log(b_from_a);
  auto covariance = CovarianceOfDifference(a, b, b_from_a);
  const auto information = covariance ? InverseOfPositive(*covariance) : std::nullopt;
  if (!information) covariance.reset();
  std::optional<Eigen::Matrix3d> of_rotation, of_centre;
  if (covariance) {
    of_rotation = covariance->topLeftCorner<3, 3>();
    of_centre = CentreCovariance(a) + CentreCovariance(b);
  }
  PoseComparison out;
  out.camera = a.camera;
  out.rotation_deg = Estimates(delta.head<3>(), of_rotation, kDegrees);
  out.centre_mm = Estimates(
      b.camera_from_lidar.Inverse().translation - a.camera_from_lidar.Inverse().translation,
      of_centre, 1000);
  out.difference = ErrorOf(b.camera_from_lidar, a.camera_from_lidar);
  if (information) out.chi2 = delta.dot(*information * delta);
  if (spec == nullptr) return out;
  const Camera camera(*spec);
  for (const double distance_m : kDistancesM) {
    out.pixels.push_back(ShiftAt(camera, b_from_a, covariance, distance_m));
  }
  return out;
}

}  // namespace rgbdt
