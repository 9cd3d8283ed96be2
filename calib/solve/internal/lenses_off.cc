#include "calib/solve/internal/lenses_off.h"

namespace rgbdt {
namespace {

LensNumbers FoundLessGiven(const JointResult& result, std::size_t camera) {
  return NumbersOf(result.solution.state.lenses[camera]) -
         NumbersOf(result.joint.problem.cameras[camera].lens());
}

}  // namespace

std::vector<LensOff> LensesOff(const JointResult& result) {
  const SharedPlaces places(result.joint.problem);
  std::vector<LensOff> off;
  for (std::size_t c = 0; c < result.joint.cameras.size(); ++c) {
    const Eigen::Index at = places.Lens(c);
    off.push_back(
        AgainstPrior(FoundLessGiven(result, c), result.joint.problem.lens_priors[c],
                     result.solution.covariance.block<kLensNumbers, kLensNumbers>(at, at)));
  }
  return off;
}

std::vector<LensOff> AgainstGiven(const JointResult& result,
                                  const std::vector<LensCovariance>& given,
                                  std::vector<LensOff> contradictions) {
  for (std::size_t c = 0; c < result.joint.cameras.size(); ++c) {
    LensOff& off = contradictions[c];
    off.off = FoundLessGiven(result, c);
    const LensCovariance found =
        CovarianceOf(result, c).bottomRightCorner<kLensNumbers, kLensNumbers>();
    off.covariance = given[c] + found;
    const bool opened = given[c].isZero(0) && !result.joint.problem.lens_priors[c].isZero(0);
    if (opened) off = AgainstPrior(off.off, found, LensCovariance::Zero());
  }
  return contradictions;
}

}  // namespace rgbdt
