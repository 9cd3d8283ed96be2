#pragma once

#include <string>

#include "calib/model/comparison.h"

namespace rgbdt {

/// In words and figures, for a terminal.
std::string ComparisonText(const CalibrationComparison& comparison);

}  // namespace rgbdt
