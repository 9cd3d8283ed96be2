#pragma once

#include <vector>

#include "calib/solve/internal/joint_solve.h"

namespace rgbdt {

/// The result with `folds` and `halves` in its cameras' reports: each part of the views left out
/// once, solved from the others and judged on it, beside the first guess from the same others; and
/// two halves of the views solved apart. Where the first guess fits what was left out better by
/// more than chance, it is kept: it becomes the report's calibration, and the status says so.
/// Nothing with fewer than 4 views.
[[nodiscard]] JointResult CrossValidate(JointResult result, int folds);

/// A camera's calibration, or its first guess where that fits views left out better by more than
/// chance: `worse` is, by view, how much larger the refined misfit is.
CameraCalibration TheBetter(const GuessedCamera& camera, const std::vector<double>& worse);

}  // namespace rgbdt
