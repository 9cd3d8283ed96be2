#include "calib/model/comparison.h"

#include <algorithm>
#include <cmath>

namespace rgbdt {

double ChanceOfChi2(double chi2) {
  const double x = std::max(0.0, chi2) / 2;
  return std::exp(-x) * (1 + x + x * x / 2);
}

bool Moved(const PoseComparison& camera) {
  return camera.chi2 && ChanceOfChi2(*camera.chi2) < kMovedChance;
}

bool ColoursMoved(const PoseComparison& camera) {
  if (camera.same_lens) return false;
  return std::any_of(camera.pixels.begin(), camera.pixels.end(), [](const PixelShift& at) {
    return at.sigma_px && at.rms_px > kTellingSigmas * *at.sigma_px;
  });
}

}  // namespace rgbdt
