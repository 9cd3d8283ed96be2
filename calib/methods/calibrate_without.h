#pragma once

#include <set>
#include <string>
#include <vector>

#include "calib/methods/calibrate.h"

namespace rgbdt {

/// Calibrate without some of the views, as a person asked for: they have no part in the result and
/// do not judge it. Each camera's warnings name them. Throws InputError where nothing remains.
Report CalibrateWithout(const Rig& rig, const std::vector<ViewDetection>& detections,
                        const std::set<std::string>& left_out, const CalibrateOptions& options);

}  // namespace rgbdt
