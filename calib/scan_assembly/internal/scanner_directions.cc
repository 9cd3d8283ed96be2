#include "calib/scan_assembly/internal/scanner_directions.h"

#include <Eigen/Cholesky>
#include <array>
#include <cmath>

namespace rgbdt {
namespace {

struct Words {
  const char* name;
  const char* gauge;  // why no sweep tells it; null: one can
  const char* room;   // what surfaces tell it
};

constexpr std::array<Words, 7> kWords = {{
    {"tilt about x", nullptr, "walls well above or below the scanner"},
    {"tilt about y", nullptr, "a ceiling or a floor away from the axis, or high walls"},
    {"turn about z",
     "a turn of the scanner about the motor's axis turns the whole cloud: it is the same as the "
     "encoder's zero, which defines the LIDAR frame's x. It does not matter: cameras are "
     "calibrated to the cloud as it comes",
     nullptr},
    {"lever arm x", nullptr, "walls to several sides"},
    {"lever arm y", nullptr, "walls to several sides"},
    {"lever arm z",
     "the scanner's height on the motor's axis lifts the whole cloud. It does not matter for "
     "calibration against cameras; measure it by hand where the motor's base itself counts",
     nullptr},
    {"encoder's zero",
     "it turns the whole cloud, so it is by definition where the LIDAR frame's x points. It does "
     "not matter: cameras are calibrated to the cloud as it comes",
     nullptr},
}};

constexpr double kLittle = 0.1;  // of all directions, seen twice

std::string WhyNot(int direction, double seen_twice) {
  const Words& words = kWords[static_cast<std::size_t>(direction)];
  if (words.gauge != nullptr) return words.gauge;
  if (seen_twice < kLittle) {
    return "hardly a surface is seen by both halves of the scan line (" +
           std::to_string(static_cast<int>(std::lround(100 * seen_twice))) +
           "% of what was hit): use a scan line that reaches over the vertical and turn by 360 "
           "degrees, 180 beyond the first surface at the least";
  }
  return std::string("the surfaces seen by both halves do not tell it; it takes ") + words.room;
}

}  // namespace

Vector7d PriorOf(const ScannerGeometryOptions& options) {
  const double a = options.tilt_prior_rad, l = options.lever_prior_m;
  return (Vector7d() << a, a, a, l, l, l, a).finished();
}

Matrix7d CovarianceOf(const Matrix7d& information, const Vector7d& prior) {
  Matrix7d observed = information;
  for (int i = 0; i < 7; ++i) {
    if (!IsGauge(i)) continue;
    observed.row(i).setZero();
    observed.col(i).setZero();
  }
  const Matrix7d whole =
      observed + Matrix7d(prior.array().square().inverse().matrix().asDiagonal());
  return whole.llt().solve(Matrix7d::Identity());
}

std::vector<ScannerDirection> DirectionsOf(const Matrix7d& covariance, const Vector7d& change,
                                           const ScannerGeometryOptions& options,
                                           double seen_twice) {
  const Vector7d prior = PriorOf(options);
  std::vector<ScannerDirection> directions;
  for (int i = 0; i < 7; ++i) {
    ScannerDirection direction;
    direction.name = kWords[static_cast<std::size_t>(i)].name;
    direction.is_angle = i < 3 || i == 6;
    direction.change = change[i];
    direction.sigma = std::sqrt(covariance(i, i));
    direction.observed = direction.sigma < options.observed_below * prior[i];
    if (!direction.observed) direction.why = WhyNot(i, seen_twice);
    directions.push_back(std::move(direction));
  }
  return directions;
}

}  // namespace rgbdt
