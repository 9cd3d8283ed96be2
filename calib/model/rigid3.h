#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace rgbdt {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// A rigid motion named `a_from_b`: point_in_a = a_from_b * point_in_b. Metres.
struct Rigid3 {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const {
    return rotation * point + translation;
  }
  Rigid3 operator*(const Rigid3& b_from_c) const {
    return {(rotation * b_from_c.rotation).normalized(),
            rotation * b_from_c.translation + translation};
  }
  Rigid3 Inverse() const {
    const Eigen::Quaterniond inverse = rotation.conjugate();
    return {inverse, -(inverse * translation)};
  }
};

/// The matrix of the cross product: CrossMatrix(a) * b = a x b.
Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d& v);

/// The exponential map of SE(3): delta = (rx, ry, rz [rad], tx, ty, tz [m]).
/// A calibration's error is defined by camera_from_lidar = Exp(delta) * estimate.
Rigid3 Exp(const Vector6d& delta);

/// The inverse of Exp for rotations below 180 degrees.
Vector6d Log(const Rigid3& motion);

/// The adjoint of SE(3): Exp(Adjoint(a_from_b) * delta) * a_from_b = a_from_b * Exp(delta). Takes
/// an error in frame b's axes, about its origin, into frame a's.
Matrix6d Adjoint(const Rigid3& a_from_b);

/// Of a covariance of delta, the part of a point's place [m^2]: the point moves by
/// delta's rotation x point + delta's translation.
Eigen::Matrix3d PointCovariance(const Matrix6d& covariance, const Eigen::Vector3d& point);

/// Rotation about one axis by `angle` [rad], no translation.
Rigid3 RotationAbout(const Eigen::Vector3d& axis, double angle);

/// The shortest rotation that takes direction `from` to direction `to`; lengths do not matter.
Eigen::Quaterniond RotationBetween(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

/// Angle of the rotation between two poses [rad], 0 to pi.
double RotationDistance(const Rigid3& a, const Rigid3& b);

/// Distance [m] between the camera centres of two `camera_from_lidar`, in the LIDAR frame.
double CentreDistance(const Rigid3& camera_from_lidar_a, const Rigid3& camera_from_lidar_b);

}  // namespace rgbdt
