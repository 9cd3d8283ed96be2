#include "calib/solve/colouring.h"

#include <array>
#include <cmath>
#include <limits>

#include "calib/camera/pixel_by_point.h"

namespace rgbdt {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Rounding may leave a variance of nothing below zero. NaN stays NaN.
double Root(double variance) { return variance < 0 ? 0 : std::sqrt(variance); }

std::array<double, 3> Sigmas(const Eigen::Matrix3d& covariance, double scale) {
  return {scale * Root(covariance(0, 0)), scale * Root(covariance(1, 1)),
          scale * Root(covariance(2, 2))};
}

double WorstPx(const Camera& camera, const PoseAndLensCovariance& covariance, double distance_m) {
  double worst = kNan;
  for (const Eigen::Vector2d& pixel : ImageGrid(camera)) {
    const auto sigma = ColouringSigmaAt(camera, covariance, pixel, distance_m);
    if (sigma) worst = std::fmax(worst, *sigma);  // of a NaN and a number, the number
  }
  return worst;
}

ColouringSigma ColouringAt(const Camera& camera, const PoseAndLensCovariance& covariance,
                           double distance_m) {
  const Eigen::Vector2d middle(0.5 * (camera.width() - 1), 0.5 * (camera.height() - 1));
  return {distance_m, ColouringSigmaAt(camera, covariance, middle, distance_m).value_or(kNan),
          WorstPx(camera, covariance, distance_m)};
}

}  // namespace

std::vector<Eigen::Vector2d> ImageGrid(const Camera& camera) {
  constexpr int kColumns = 25;
  constexpr int kRows = 19;
  std::vector<Eigen::Vector2d> grid;
  grid.reserve(kColumns * kRows);
  for (int y = 0; y < kRows; ++y) {
    for (int x = 0; x < kColumns; ++x) {
      grid.emplace_back(x * (camera.width() - 1.0) / (kColumns - 1),
                        y * (camera.height() - 1.0) / (kRows - 1));
    }
  }
  return grid;
}

std::optional<double> ColouringSigmaAt(const Camera& camera,
                                       const PoseAndLensCovariance& covariance,
                                       const Eigen::Vector2d& pixel, double distance_m) {
  const auto direction = camera.Unproject(pixel);
  if (!direction) return std::nullopt;
  const Eigen::Vector3d point = distance_m * *direction;
  const PixelDerivatives by = PixelByPointAndLens(camera.lens(), point);
  const Eigen::Matrix<double, 2, 3> by_point = by.leftCols<3>();
  Eigen::Matrix<double, 2, kPoseAndLens> j;
  j << -by_point * CrossMatrix(point), by_point, by.rightCols<kLensNumbers>();
  return Root((j * covariance * j.transpose()).trace());
}

std::vector<ColouringSigma> ColouringSigmas(const CameraSpec& spec,
                                            const CameraCalibration& calibration,
                                            const std::vector<double>& distances_m) {
  const Camera camera(calibration.WithSolvedLens(spec));
  const PoseAndLensCovariance covariance = calibration.PoseAndLens();
  std::vector<ColouringSigma> sigmas;
  for (const double distance_m : distances_m) {
    sigmas.push_back(ColouringAt(camera, covariance, distance_m));
  }
  return sigmas;
}

PoseSigma SigmaOf(const CameraSpec& spec, const CameraCalibration& calibration) {
  const PoseAndLensCovariance covariance = calibration.PoseAndLens();
  const Eigen::Matrix3d r = calibration.camera_from_lidar.rotation.toRotationMatrix();
  PoseSigma sigma;
  sigma.rotation_deg = Sigmas(covariance.topLeftCorner<3, 3>(), 180 / M_PI);
  sigma.centre_mm = Sigmas(r.transpose() * covariance.block<3, 3>(3, 3) * r, 1000);
  sigma.colouring = ColouringSigmas(
      spec, calibration, {std::begin(kColouringDistancesM), std::end(kColouringDistancesM)});
  return sigma;
}

}  // namespace rgbdt
