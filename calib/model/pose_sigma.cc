#include "calib/model/pose_sigma.h"

#include <algorithm>
#include <cmath>

#include "calib/model/linear_algebra.h"

namespace rgbdt {
namespace {

double Largest(const Eigen::Matrix3d& covariance) {
  return std::sqrt(std::max(0.0, EigensystemOf(covariance).values[2]));
}

}  // namespace

// The centre moves by -R' times delta's translation: the largest is the same in either frame.
std::optional<PoseError> WorstAxisSigma(const CameraCalibration& calibration) {
  if (!calibration.covariance || !calibration.covariance->allFinite()) return std::nullopt;
  const Matrix6d& covariance = *calibration.covariance;
  return PoseError{Largest(covariance.topLeftCorner<3, 3>()) * 180 / M_PI,
                   Largest(covariance.bottomRightCorner<3, 3>()) * 1000};
}

// The origin moves with the rotation, too.
std::optional<PoseError> WorstAxisSigma(const LidarCalibration& calibration) {
  if (!calibration.covariance || !calibration.covariance->allFinite()) return std::nullopt;
  const Matrix6d& covariance = *calibration.covariance;
  return PoseError{
      Largest(covariance.topLeftCorner<3, 3>()) * 180 / M_PI,
      Largest(PointCovariance(covariance, calibration.reference_from_lidar.translation)) * 1000};
}

LidarSigma SigmaOf(const LidarCalibration& calibration) {
  const Matrix6d& covariance = *calibration.covariance;
  const Eigen::Matrix3d origin =
      PointCovariance(covariance, calibration.reference_from_lidar.translation);
  LidarSigma sigma;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const auto axis = static_cast<std::size_t>(i);
    sigma.rotation_deg[axis] = std::sqrt(std::max(0.0, covariance(i, i))) * 180 / M_PI;
    sigma.translation_mm[axis] = std::sqrt(std::max(0.0, origin(i, i))) * 1000;
  }
  return sigma;
}

PoseChange ChangeOf(const CameraCalibration& from, const CameraCalibration& to) {
  PoseChange change;
  change.difference = ErrorOf(to.camera_from_lidar, from.camera_from_lidar);
  if (!from.covariance || !from.covariance->allFinite()) return change;
  const Vector6d delta = Log(to.camera_from_lidar * from.camera_from_lidar.Inverse());
  const double chi2 = delta.dot(SolveSymmetric(*from.covariance, delta));
  if (std::isfinite(chi2)) change.sigmas = std::sqrt(std::max(0.0, chi2));
  return change;
}

}  // namespace rgbdt
