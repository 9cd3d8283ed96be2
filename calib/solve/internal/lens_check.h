#pragma once

#include "calib/model/lens.h"

namespace rgbdt {

/// How far a lens that was solved for lies from what was known of it.
struct LensOff {
  LensNumbers off = LensNumbers::Zero();               ///< found minus given
  LensCovariance covariance = LensCovariance::Zero();  ///< of `off`, what was given counted in
  double chi2 = 0;
  int freedom = 0;  ///< directions that the views tell anything of, of chi2

  /// Beyond what chance does once in 10,000 sessions.
  bool contradicts() const;
};

/// Of an unknown with a prior C0 about zero and a posterior C, `off` has the covariance C0 - C
/// where the prior holds (Hausman 1978); taken along the directions in which the data tell
/// anything.
LensOff AgainstPrior(const LensNumbers& off, const LensCovariance& prior,
                     const LensCovariance& posterior);

}  // namespace rgbdt
