#pragma once

// What a report says of LIDARs beside the reference. Empty where there are none.

#include <string>

#include "calib/model/calibration.h"
#include "calib/present/report/table.h"

namespace rgbdt {

/// Where each sits, how exactly, and how its solve ended.
Table FurtherLidarsTable(const Report& report);
/// What was solved for of each besides its pose.
Table FurtherNuisanceTable(const Report& report);

/// For a terminal: a line for each.
std::string FurtherLidarLines(const Report& report);

}  // namespace rgbdt
