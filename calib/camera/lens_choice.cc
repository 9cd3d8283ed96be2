#include "calib/camera/lens_choice.h"

#include <algorithm>
#include <cmath>

namespace rgbdt {
namespace {

// By the usual reading of the criterion's difference (Kass and Raftery 1995): "very strong".
constexpr double kClearBic = 10;
// Corners' errors are alike within an image, which the criterion does not know: it takes what is
// too small to matter for real.
constexpr double kClearRms = 0.95;
// A model that the images want is found in 20 to 40; others wander on.
constexpr int kMostIterations = 50;
// No corner is found better than that [px].
constexpr double kLeastSigma = 0.02;

struct SameCorners {
  double squares = 0, asked_squares = 0;  // [px^2]
  int corners = 0;
};

// Those that the other model uses, in views that the one asked for could place.
SameCorners OnSameCorners(const IntrinsicsResult& other, const IntrinsicsResult& asked) {
  SameCorners same;
  for (std::size_t v = 0; v < other.views.size(); ++v) {
    const IntrinsicsViewFit& view = other.views[v];
    const IntrinsicsViewFit& before = asked.views[v];
    if (!view.rejected.empty() || before.camera_from_target.translation.isZero(0)) continue;
    for (std::size_t i = 0; i < view.used.size(); ++i) {
      if (!view.used[i]) continue;
      same.squares += view.residuals_px[i].squaredNorm();
      same.asked_squares += before.residuals_px[i].squaredNorm();
      ++same.corners;
    }
  }
  return same;
}

LensAlternative Against(const IntrinsicsResult& other, const IntrinsicsResult& asked) {
  LensAlternative alternative{other.choice, other.converged, other.rms_px, 0, 0};
  const SameCorners same = OnSameCorners(other, asked);
  if (same.corners == 0) return alternative;
  const double n = 2.0 * same.corners;
  const double least = n * kLeastSigma * kLeastSigma;
  const double numbers =
      static_cast<double>(other.values.size()) - static_cast<double>(asked.values.size());
  alternative.rms_px = std::sqrt(same.squares / same.corners);
  alternative.asked_rms_px = std::sqrt(same.asked_squares / same.corners);
  alternative.bic =
      n * std::log((same.squares + least) / (same.asked_squares + least)) + numbers * std::log(n);
  return alternative;
}

bool IsBetter(const LensAlternative& other, LensChoice asked) {
  if (!other.converged) return false;
  if (asked == LensChoice::kPinhole8 && other.choice == LensChoice::kPinhole5 && other.bic < 0) {
    return true;
  }
  return other.bic < -kClearBic && other.rms_px < kClearRms * other.asked_rms_px;
}

}  // namespace

LensComparison CompareLenses(const IntrinsicsInput& input, const IntrinsicsResult& result,
                             const IntrinsicsOptions& options) {
  LensComparison comparison{result.choice, {}, {}};
  IntrinsicsOptions brief = options;
  brief.max_iterations = std::min(brief.max_iterations, kMostIterations);
  for (const LensChoice choice :
       {LensChoice::kPinhole5, LensChoice::kPinhole8, LensChoice::kFisheye}) {
    if (choice == result.choice) continue;
    IntrinsicsInput other = input;
    other.choice = choice;
    const LensAlternative alternative = Against(CalibrateIntrinsics(other, brief), result);
    comparison.others.push_back(alternative);
    if (!IsBetter(alternative, result.choice)) continue;
    if (!comparison.better || alternative.bic < comparison.better->bic) {
      comparison.better = alternative;
    }
  }
  return comparison;
}

}  // namespace rgbdt
