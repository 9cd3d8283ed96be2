#pragma once

// Inside calib/files only: what a report says about how sure it is, as pieces of HTML. Each is
// empty where the report has nothing to say.

#include <string>

#include "calib/model/calibration.h"

namespace rgbdt {

/// One camera's sigmas, the residuals in theirs, the views left out in turn, the two halves and
/// the unknowns besides the pose.
std::string SurenessHtml(const CameraReport& camera);

/// The cameras against each other.
std::string ClosureHtml(const Report& report);

std::string NextViewHtml(const Report& report);

}  // namespace rgbdt
