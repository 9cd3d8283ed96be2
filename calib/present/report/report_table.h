#pragma once

#include <string>

#include "calib/model/calibration.h"

namespace rgbdt {

/// The report as a table for a terminal, units in the first column, cameras side by side.
std::string ReportTable(const Report& report);

/// Whether every camera converged.
bool AllConverged(const Report& report);

}  // namespace rgbdt
