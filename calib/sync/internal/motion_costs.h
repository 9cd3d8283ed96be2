#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>

#include "calib/sync/internal/quadratic.h"
#include "calib/sync/internal/spline.h"
#include "calib/sync/internal/sweep_motion.h"

// Residuals of the motion problem, for Ceres: each about a state, its parameters what is added to
// that.
namespace rgbdt::sync {

// How the board's way changes its acceleration is noise of so much at each knot: some times what a
// person's arms do, so that it only bridges what no sensor sees.
inline constexpr double kJerk = 100;      // [m/s^3]
inline constexpr double kTurnJerk = 200;  // [rad/s^3]

template <typename T>
std::array<Pose<T>, 4> Moved(const std::array<Rigid3, 4>& base, const T* a, const T* b, const T* c,
                             const T* d) {
  return {MovedKnot(base[0], a), MovedKnot(base[1], b), MovedKnot(base[2], c),
          MovedKnot(base[3], d)};
}

template <typename T, typename Vector>
void Weigh(const Quadratic& quadratic, double factor, const Vector& xi, T* residuals) {
  for (int i = 0; i < Quadratic::kSize; ++i) {
    T sum = T(quadratic.rest[i]);
    for (int k = 0; k < Quadratic::kSize; ++k) sum += quadratic.root(i, k) * xi[k];
    residuals[i] = sum / std::sqrt(factor);
  }
}

// An image: the board at its time, through the camera, against what its corners tell.
struct ImageCost {
  std::array<Rigid3, 4> knots;
  Rigid3 camera_from_lidar;
  double within = 0, step_s = 0;  // at unknowns of zero
  double middle_row = 0, share = 0;
  double rolling_s = 0;
  Rigid3 predicted;  // camera_from_target, about which `quadratic` is
  Vector6d predicted_by_row;
  Quadratic quadratic;
  double factor = 1;

  template <typename T>
  bool operator()(const T* a, const T* b, const T* c, const T* d, const T* pose, const T* offset,
                  const T* change_from, const T* change_to, const T* rolling, T* residuals) const {
    const auto moved = Moved(knots, a, b, c, d);
    const Pose<T> camera = [&] {
      const Vector3<T> turn(pose[0], pose[1], pose[2]);
      const Vector3<T> shift(pose[3], pose[4], pose[5]);
      return Pose<T>{ExpRotation(turn), shift} * Cast<T>(camera_from_lidar);
    }();
    const T later =
        offset[0] + (1 - share) * change_from[0] + share * change_to[0] + rolling[0] * middle_row;
    const T u = T(within) + later / step_s;
    const Pose<T> at = camera * SplineAt(moved, u);
    const Pose<T> before = camera * SplineAt<T>(moved, u - kHalfInterval);
    const Pose<T> after = camera * SplineAt<T>(moved, u + kHalfInterval);
    const Eigen::Matrix<T, 6, 1> by_row =
        TwistBetween(before, after, kHalfInterval * step_s) * (rolling_s + rolling[0]);
    Eigen::Matrix<T, Quadratic::kSize, 1> xi;
    xi << SmallLog(at * Cast<T>(predicted.Inverse())), by_row - predicted_by_row.cast<T>(), T(0);
    Weigh(quadratic, factor, xi, residuals);
    return true;
  }
};

// A sweep: the board at its time and its motion, against what the points tell.
struct SweepCost {
  std::array<Rigid3, 4> knots;
  double within = 0, step_s = 0;
  SweepMotion motion;
  double factor = 1;

  template <typename T>
  bool operator()(const T* a, const T* b, const T* c, const T* d, const T* range,
                  T* residuals) const {
    const auto moved = Moved(knots, a, b, c, d);
    const Pose<T> at = SplineAt<T>(moved, T(within));
    const Pose<T> before = SplineAt<T>(moved, T(within - kHalfInterval));
    const Pose<T> after = SplineAt<T>(moved, T(within + kHalfInterval));
    Eigen::Matrix<T, Quadratic::kSize, 1> xi;
    xi << SmallLog(at * Cast<T>(motion.lidar_from_target.Inverse())),
        TwistBetween(before, after, kHalfInterval * step_s) - motion.twist.cast<T>(), range[0];
    Weigh(motion.quadratic, factor, xi, residuals);
    return true;
  }
};

// Four knots in a row: third differences of places and of rotations.
struct JerkCost {
  std::array<Rigid3, 4> knots;
  double step_s = 0;

  template <typename T>
  bool operator()(const T* a, const T* b, const T* c, const T* d, T* residuals) const {
    const auto k = Moved(knots, a, b, c, d);
    const double cube = step_s * step_s * step_s;
    const Vector3<T> jerk =
        (k[3].translation - T(3) * k[2].translation + T(3) * k[1].translation - k[0].translation) /
        T(cube * kJerk);
    Vector3<T> turn[3];
    for (std::size_t i = 0; i < 3; ++i) {
      turn[i] = LogRotation<T>(k[i].rotation.conjugate() * k[i + 1].rotation);
    }
    const Vector3<T> turn_jerk = (turn[2] - T(2) * turn[1] + turn[0]) / T(cube * kTurnJerk);
    for (int i = 0; i < 3; ++i) {
      residuals[i] = jerk[i];
      residuals[3 + i] = turn_jerk[i];
    }
    return true;
  }
};

struct PosePrior {
  Rigid3 camera_from_lidar, prior;
  Matrix6d root;  // root^T root is the information

  template <typename T>
  bool operator()(const T* pose, T* residuals) const {
    const Vector3<T> turn(pose[0], pose[1], pose[2]);
    const Vector3<T> shift(pose[3], pose[4], pose[5]);
    const Pose<T> moved = Pose<T>{ExpRotation(turn), shift} * Cast<T>(camera_from_lidar);
    const Eigen::Matrix<T, 6, 1> off = SmallLog(moved * Cast<T>(prior.Inverse()));
    for (int i = 0; i < 6; ++i) {
      residuals[i] = T(0);
      for (int k = 0; k < 6; ++k) residuals[i] += root(i, k) * off[k];
    }
    return true;
  }
};

struct ScalarPrior {
  double value = 0, sigma = 1;  // of the unknown at zero

  template <typename T>
  bool operator()(const T* x, T* residuals) const {
    residuals[0] = (T(value) + x[0]) / sigma;
    return true;
  }
};

// Two of a clock's places in a row.
struct ChangePrior {
  double difference = 0, sigma = 1;  // of the unknowns at zero

  template <typename T>
  bool operator()(const T* from, const T* to, T* residuals) const {
    residuals[0] = (T(difference) + to[0] - from[0]) / sigma;
    return true;
  }
};

}  // namespace rgbdt::sync
