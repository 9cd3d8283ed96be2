#include "calib/solve/colouring.h"

#include <array>
#include <cmath>
#include <limits>
#include <set>

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

// At all pixels of the grid that look anywhere.
std::vector<ColouringVariance> AllOver(const Camera& camera,
                                       const PoseAndLensCovariance& covariance) {
  std::vector<ColouringVariance> all;
  for (const Eigen::Vector2d& pixel : ImageGrid(camera)) {
    if (const auto variance = ColouringVarianceOf(camera, covariance, pixel)) {
      all.push_back(*variance);
    }
  }
  return all;
}

// The index of the largest at a distance; of a NaN and a number, the number.
std::optional<std::size_t> WorstOf(const std::vector<ColouringVariance>& all, double distance_m) {
  std::optional<std::size_t> worst;
  double most = -1;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double sigma = all[i].SigmaAt(distance_m);
    if (!(sigma > most)) continue;
    most = sigma;
    worst = i;
  }
  return worst;
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

double ColouringVariance::SigmaAt(double distance_m) const {
  return Root(lasting + per_m / distance_m + per_m2 / (distance_m * distance_m));
}

std::optional<ColouringVariance> ColouringVarianceOf(const Camera& camera,
                                                     const PoseAndLensCovariance& covariance,
                                                     const Eigen::Vector2d& pixel) {
  const auto direction = camera.Unproject(pixel);
  if (!direction) return std::nullopt;
  const PixelDerivatives by = PixelByPointAndLens(camera.lens(), *direction);
  const Eigen::Matrix<double, 2, 3> by_point = by.leftCols<3>();  // of a point one metre away
  using Derivatives = Eigen::Matrix<double, 2, kPoseAndLens>;
  Derivatives lasting = Derivatives::Zero();
  Derivatives per_m = Derivatives::Zero();
  lasting.leftCols<3>() = -by_point * CrossMatrix(*direction);
  lasting.rightCols<kLensNumbers>() = by.rightCols<kLensNumbers>();
  per_m.middleCols<3>(3) = by_point;
  return ColouringVariance{(lasting * covariance * lasting.transpose()).trace(),
                           2 * (lasting * covariance * per_m.transpose()).trace(),
                           (per_m * covariance * per_m.transpose()).trace()};
}

std::optional<double> ColouringSigmaAt(const Camera& camera,
                                       const PoseAndLensCovariance& covariance,
                                       const Eigen::Vector2d& pixel, double distance_m) {
  const auto variance = ColouringVarianceOf(camera, covariance, pixel);
  return variance ? std::optional(variance->SigmaAt(distance_m)) : std::nullopt;
}

std::vector<ColouringVariance> WorstColouring(const CameraSpec& spec,
                                              const CameraCalibration& calibration) {
  constexpr double kNearestM = 0.3, kFarthestM = 300;
  constexpr int kSteps = 300;
  const auto all = AllOver(Camera(calibration.WithSolvedLens(spec)), calibration.PoseAndLens());
  std::set<std::size_t> worst;
  for (int i = 0; i <= kSteps; ++i) {
    const double share = static_cast<double>(i) / kSteps;
    const auto at = WorstOf(all, kNearestM * std::pow(kFarthestM / kNearestM, share));
    if (at) worst.insert(*at);
  }
  std::vector<ColouringVariance> out;
  for (const std::size_t i : worst) out.push_back(all[i]);
  return out;
}

PoseSigma SigmaOf(const CameraSpec& spec, const CameraCalibration& calibration) {
  const PoseAndLensCovariance covariance = calibration.PoseAndLens();
  const Eigen::Matrix3d r = calibration.camera_from_lidar.rotation.toRotationMatrix();
  PoseSigma sigma;
  sigma.rotation_deg = Sigmas(covariance.topLeftCorner<3, 3>(), 180 / M_PI);
  sigma.centre_mm = Sigmas(r.transpose() * covariance.block<3, 3>(3, 3) * r, 1000);
  const Camera camera(calibration.WithSolvedLens(spec));
  const auto all = AllOver(camera, covariance);
  const Eigen::Vector2d middle(0.5 * (camera.width() - 1), 0.5 * (camera.height() - 1));
  for (const double distance_m : kColouringDistancesM) {
    const auto worst = WorstOf(all, distance_m);
    sigma.colouring.push_back(
        {distance_m, ColouringSigmaAt(camera, covariance, middle, distance_m).value_or(kNan),
         worst ? all[*worst].SigmaAt(distance_m) : kNan});
  }
  return sigma;
}

}  // namespace rgbdt
