#pragma once

#include <vector>

#include "calib/methods/calibrate.h"

namespace rgbdt {

/// How a calibration came about: solved again, in milliseconds each, with the first view that
/// `report` used, with the first two, and so on. The last report is `report` itself, and the only
/// one of a method other than "auto".
std::vector<Report> CalibrateByViews(const Rig& rig, const std::vector<ViewDetection>& detections,
                                     const Report& report);

}  // namespace rgbdt
