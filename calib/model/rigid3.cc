#include "calib/model/rigid3.h"

#include <cmath>

namespace rgbdt {

Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

namespace {

// The left Jacobian of SO(3): translation = LeftJacobian(rotation vector) * (tx, ty, tz).
Eigen::Matrix3d LeftJacobian(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  const Eigen::Matrix3d k = CrossMatrix(w);
  if (angle < 1e-5) return Eigen::Matrix3d::Identity() + 0.5 * k + k * k / 6.0;
  const double a2 = angle * angle;
  const double half_sine = std::sin(0.5 * angle);  // 1 - cos(angle) would lose its digits
  return Eigen::Matrix3d::Identity() + 2 * half_sine * half_sine / a2 * k +
         (angle - std::sin(angle)) / (a2 * angle) * k * k;
}

Eigen::Quaterniond QuaternionFromRotationVector(const Eigen::Vector3d& w) {
  const double half = 0.5 * w.norm();
  // sin(half) / (2 half), by its series near zero.
  const double scale = half < 1e-5 ? 0.5 - half * half / 12.0 : 0.5 * std::sin(half) / half;
  return Eigen::Quaterniond(std::cos(half), scale * w.x(), scale * w.y(), scale * w.z())
      .normalized();
}

Eigen::Vector3d RotationVector(Eigen::Quaterniond q) {
  if (q.w() < 0) q.coeffs() *= -1;
  const double sine = q.vec().norm();
  if (sine < 1e-10) return 2.0 * q.vec();
  return 2.0 * std::atan2(sine, q.w()) / sine * q.vec();
}

}  // namespace

Rigid3 Exp(const Vector6d& delta) {
  const Eigen::Vector3d w = delta.head<3>();
  return {QuaternionFromRotationVector(w), LeftJacobian(w) * delta.tail<3>()};
}

Vector6d Log(const Rigid3& motion) {
  Vector6d delta;
  const Eigen::Vector3d w = RotationVector(motion.rotation);
  delta << w, LeftJacobian(w).inverse() * motion.translation;
  return delta;
}

Matrix6d Adjoint(const Rigid3& a_from_b) {
  const Eigen::Matrix3d r = a_from_b.rotation.toRotationMatrix();
  Matrix6d out = Matrix6d::Zero();
  out.topLeftCorner<3, 3>() = r;
  out.bottomRightCorner<3, 3>() = r;
  out.bottomLeftCorner<3, 3>() = CrossMatrix(a_from_b.translation) * r;
  return out;
}

Eigen::Matrix3d PointCovariance(const Matrix6d& covariance, const Eigen::Vector3d& point) {
  Eigen::Matrix<double, 3, 6> j;
  j << -CrossMatrix(point), Eigen::Matrix3d::Identity();
  return j * covariance * j.transpose();
}

Rigid3 RotationAbout(const Eigen::Vector3d& axis, double angle) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis.normalized())), Eigen::Vector3d::Zero()};
}

Eigen::Quaterniond RotationBetween(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d a = from.normalized();
  const Eigen::Vector3d b = to.normalized();
  const double cosine = b.dot(a);
  if (cosine < -1 + 1e-12) {  // opposite: about any axis across
    const Eigen::Vector3d axis = a.unitOrthogonal();
    return Eigen::Quaterniond(0, axis.x(), axis.y(), axis.z());
  }
  const Eigen::Vector3d axis = a.cross(b);
  const double twice_w = std::sqrt((1 + cosine) * 2);
  const Eigen::Vector3d v = axis * (1 / twice_w);
  return Eigen::Quaterniond(twice_w * 0.5, v.x(), v.y(), v.z());
}

double RotationDistance(const Rigid3& a, const Rigid3& b) {
  return RotationVector(a.rotation * b.rotation.conjugate()).norm();
}

double CentreDistance(const Rigid3& camera_from_lidar_a, const Rigid3& camera_from_lidar_b) {
  return (camera_from_lidar_a.Inverse().translation - camera_from_lidar_b.Inverse().translation)
      .norm();
}

}  // namespace rgbdt
