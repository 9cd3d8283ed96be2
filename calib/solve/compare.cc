#include "calib/solve/compare.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/camera/camera.h"
#include "calib/model/linear_algebra.h"
#include "calib/solve/colouring.h"

namespace rgbdt {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kDegrees = 180 / M_PI;
constexpr double kDistancesM[] = {2, 5, 10};

// Two calibrations whose poses have covariances, and the covariance of b's delta with a's.
struct Stated {
  const CameraCalibration& a;
  const CameraCalibration& b;
  Matrix6d b_with_a;

  // Of Log(b a^-1).
  Matrix6d OfDifference() const {
    const Matrix6d adjoint = Adjoint(b.camera_from_lidar * a.camera_from_lidar.Inverse());
    const Matrix6d both = b_with_a * adjoint.transpose();
    return *b.covariance + adjoint * *a.covariance * adjoint.transpose() - both - both.transpose();
  }

  // Of the difference of the cameras' centres, LIDAR axes: each moves by -R' of its delta's
  // translation.
  Eigen::Matrix3d OfCentres() const {
    const Eigen::Matrix3d of_a = a.camera_from_lidar.rotation.toRotationMatrix();
    const Eigen::Matrix3d of_b = b.camera_from_lidar.rotation.toRotationMatrix();
    const auto part = [](const Matrix6d& m) { return m.bottomRightCorner<3, 3>(); };
    const Eigen::Matrix3d both = of_b.transpose() * part(b_with_a) * of_a;
    return of_b.transpose() * part(*b.covariance) * of_b +
           of_a.transpose() * part(*a.covariance) * of_a - both - both.transpose();
  }
};

bool HaveCovariances(const CameraCalibration& a, const CameraCalibration& b) {
  return a.converged() && b.converged() && a.covariance && b.covariance;
}

std::array<Estimate, 3> Estimates(const Eigen::Vector3d& values,
                                  const std::optional<Eigen::Matrix3d>& covariance, double scale) {
  std::array<Estimate, 3> out;
  for (int k = 0; k < 3; ++k) {
    const double sigma = covariance ? std::sqrt(std::max(0.0, (*covariance)(k, k))) : kUnknown;
    out[static_cast<std::size_t>(k)] = {scale * values[k], scale * sigma};
  }
  return out;
}

// Both with their lenses; where the two can be compared, what counts of each one's uncertainty.
struct Pair {
  Camera a, b;
  Rigid3 b_from_a;
  std::optional<PoseAndLensCovariance> of_a, of_b;
};

// With the lens in common, which moves both alike, that of the difference alone is left.
PoseAndLensCovariance OfPoseAlone(const Matrix6d& covariance) {
  PoseAndLensCovariance out = PoseAndLensCovariance::Zero();
  out.topLeftCorner<6, 6>() = covariance;
  return out;
}

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
  shift.rms_px = count > 0 ? std::sqrt(squares / count) : kUnknown;
  if (pair.of_a && pair.of_b && count > 0) shift.sigma_px = std::sqrt(variances / count);
  return shift;
}

}  // namespace

PoseComparison Compare(const CameraCalibration& a, const CameraCalibration& b,
                       const CameraSpec* spec, const std::optional<Matrix6d>& b_with_a) {
  const Rigid3 b_from_a = b.camera_from_lidar * a.camera_from_lidar.Inverse();
  const Vector6d delta = Log(b_from_a);
  const Stated stated{a, b, b_with_a.value_or(Matrix6d::Zero())};
  std::optional<Matrix6d> covariance, information;
  if (HaveCovariances(a, b)) covariance = stated.OfDifference();
  if (covariance) {
    if (const auto inverse = InverseOfPositive(*covariance)) information = Matrix6d(*inverse);
  }
  std::optional<Eigen::Matrix3d> of_rotation, of_centre;
  if (information) {
    of_rotation = covariance->topLeftCorner<3, 3>();
    of_centre = stated.OfCentres();
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
  out.same_lens = b_with_a || pair.a.lens() == pair.b.lens();
  if (information) {
    pair.of_a = b_with_a ? OfPoseAlone(Matrix6d::Zero()) : a.PoseAndLens();
    pair.of_b = b_with_a ? OfPoseAlone(*covariance) : b.PoseAndLens();
  }
  for (const double distance_m : kDistancesM) out.pixels.push_back(ShiftAt(pair, distance_m));
  return out;
}

}  // namespace rgbdt
