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

// Both with their lenses; the covariance of each where the two can be compared.
struct Pair {
  Camera a, b;
  Rigid3 b_from_a;
  std::optional<PoseAndLensCovariance> of_a, of_b;
};

// A point that a sees at `pixel`, seen by b. Where there are covariances, the sum of both.
PixelShift ShiftAt(const Pair& pair, double distance_m) {
  PixelShift shift;
  shift.distance_m = distance_m;
  double squares = 0;
  double variances = 0;
  int count = 0;
  for (const Eigen::Vector2d& pixel : ImageGrid(pair.a)) {
    const auto direction = pair.a.Unproject(pixel);
    if (!direction) continue;
    const auto moved = pair.b.Project(pair.b_from_a * Eigen::Vector3d(distance_m * *direction));
    if (!moved) continue;
    if (pair.of_a && pair.of_b) {
      const auto a = ColouringSigmaAt(pair.a, *pair.of_a, pixel, distance_m);
      const auto b = ColouringSigmaAt(pair.b, *pair.of_b, pixel, distance_m);
      if (!a || !b) continue;
      variances += *a * *a + *b * *b;
    }
    squares += (*moved - pixel).squaredNorm();
    ++count;
  }
  shift.rms_px = count > 0 ? std::sqrt(squares / count) : kNan;
  if (pair.of_a && pair.of_b && count > 0) shift.sigma_px = std::sqrt(variances / count);
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
  Pair pair{Camera(a.WithSolvedLens(*spec)), Camera(b.WithSolvedLens(*spec)), b_from_a, {}, {}};
  if (covariance) {
    pair.of_a = a.PoseAndLens();
    pair.of_b = b.PoseAndLens();
  }
  for (const double distance_m : kDistancesM) out.pixels.push_back(ShiftAt(pair, distance_m));
  return out;
}

}  // namespace rgbdt
