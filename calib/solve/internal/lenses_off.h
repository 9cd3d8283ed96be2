#pragma once

#include <vector>

#include "calib/solve/internal/joint_solve.h"

namespace rgbdt {

/// By camera: how far the lens that was found lies from the given one, against the prior that the
/// problem has for it.
std::vector<LensOff> LensesOff(const JointResult& result);

/// The same as a report has it, with sigmas against what was `given`: where that was less certain
/// than the problem has it, by `contradictions`, what was told before it was. Of a lens that was
/// given as exact and is free in the problem, against nothing but what the views tell.
std::vector<LensOff> AgainstGiven(const JointResult& result,
                                  const std::vector<LensCovariance>& given,
                                  std::vector<LensOff> contradictions);

}  // namespace rgbdt
