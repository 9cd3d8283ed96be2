#pragma once

#include <ceres/rotation.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "calib/model/rigid3.h"
#include "calib/model/time.h"

namespace rgbdt::sync {

template <typename T>
using Vector3 = Eigen::Matrix<T, 3, 1>;

/// Rigid3 of any scalar.
template <typename T>
struct Pose {
  Eigen::Quaternion<T> rotation;
  Vector3<T> translation;

  Pose operator*(const Pose& other) const {
    return {rotation * other.rotation, rotation * other.translation + translation};
  }
  Pose Inverse() const {
    const Eigen::Quaternion<T> inverse = rotation.conjugate();
    return {inverse, -(inverse * translation)};
  }
};

template <typename T>
Pose<T> Cast(const Rigid3& pose) {
  return {pose.rotation.cast<T>(), pose.translation.cast<T>()};
}

template <typename T>
Eigen::Quaternion<T> ExpRotation(const Vector3<T>& vector) {
  T q[4];
  ceres::AngleAxisToQuaternion(vector.data(), q);
  return {q[0], q[1], q[2], q[3]};
}

template <typename T>
Vector3<T> LogRotation(const Eigen::Quaternion<T>& rotation) {
  const T q[4] = {rotation.w(), rotation.x(), rotation.y(), rotation.z()};
  Vector3<T> vector;
  ceres::QuaternionToAngleAxis(q, vector.data());
  return vector;
}

/// rigid3.h's Log, to the second order of the rotation: for motions of some degrees.
template <typename T>
Eigen::Matrix<T, 6, 1> SmallLog(const Pose<T>& motion) {
  const Vector3<T> turn = LogRotation(motion.rotation);
  Eigen::Matrix<T, 6, 1> twist;
  twist << turn, motion.translation - T(0.5) * turn.cross(motion.translation);
  return twist;
}

/// A knot moved by its unknowns: turned (from the left), shifted.
template <typename T>
Pose<T> MovedKnot(const Rigid3& knot, const T* delta) {
  const Vector3<T> turn(delta[0], delta[1], delta[2]);
  return {ExpRotation(turn) * knot.rotation.cast<T>(),
          knot.translation.cast<T>() + Vector3<T>(delta[3], delta[4], delta[5])};
}

/// The uniform cubic B-spline between its second and third knot at u = 0 to 1, places and rotations
/// apart (R^3 x SO(3)), rotations in cumulative form (Kim, Kim and Shin 1995). Smooth a little
/// beyond, too.
template <typename T>
Pose<T> SplineAt(const std::array<Pose<T>, 4>& knots, const T& u) {
  const T share[3] = {(T(5) + u * (T(3) - u * (T(3) - u))) / T(6),
                      (T(1) + u * (T(3) + u * (T(3) - T(2) * u))) / T(6), u * u * u / T(6)};
  Pose<T> at = knots[0];
  for (int k = 0; k < 3; ++k) {
    const auto& from = knots[static_cast<std::size_t>(k)];
    const auto& to = knots[static_cast<std::size_t>(k) + 1];
    at.translation += share[k] * (to.translation - from.translation);
    at.rotation =
        at.rotation *
        ExpRotation<T>(share[k] * LogRotation<T>(from.rotation.conjugate() * to.rotation));
  }
  return at;
}

/// Half of the time over which a velocity is measured, in knot intervals.
inline constexpr double kHalfInterval = 0.02;

/// d/dt of a pose that goes from `before` to `after` in 2 `half_s`: Exp(t * twist) * pose.
template <typename T>
Eigen::Matrix<T, 6, 1> TwistBetween(const Pose<T>& before, const Pose<T>& after, double half_s) {
  return SmallLog(after * before.Inverse()) / T(2 * half_s);
}

/// The board's way: lidar_from_target over time.
struct Trajectory {
  Utime start = 0;
  double step_s = 0.05;
  std::vector<Rigid3> knots;  ///< knot i stands for start + (i - 1) * step_s

  /// The last time that it tells [s since start].
  double Length() const { return (static_cast<double>(knots.size()) - 3) * step_s; }
  /// Of a time [s since start]: the first of its four knots, and how far it is beyond the second.
  int Segment(double seconds) const {
    return static_cast<int>(
        std::clamp(std::floor(seconds / step_s), 0.0, static_cast<double>(knots.size()) - 4));
  }
  double Within(double seconds, int segment) const { return seconds / step_s - segment; }
  std::array<Rigid3, 4> KnotsOf(int segment) const {
    const auto i = static_cast<std::size_t>(segment);
    return {knots[i], knots[i + 1], knots[i + 2], knots[i + 3]};
  }

  Rigid3 At(double seconds) const {
    const int segment = Segment(seconds);
    std::array<Pose<double>, 4> four;
    for (std::size_t k = 0; k < 4; ++k) {
      four[k] = Cast<double>(knots[static_cast<std::size_t>(segment) + k]);
    }
    const Pose<double> pose = SplineAt(four, Within(seconds, segment));
    return {pose.rotation.normalized(), pose.translation};
  }
  /// d/dt lidar_from_target [rad/s, m/s], LIDAR axes, about its origin.
  Vector6d TwistAt(double seconds) const {
    const double half = kHalfInterval * step_s;
    return TwistBetween(Cast<double>(At(seconds - half)), Cast<double>(At(seconds + half)), half);
  }
};

}  // namespace rgbdt::sync
