#pragma once

#include <string>
#include <vector>

#include "calib/present/report/intrinsics_text.h"

namespace rgbdt {

/// One page that needs nothing else (no script, no network): for each camera whether it can be
/// trusted, every parameter with its sigma, a drawing of all corners with their residuals, every
/// view. The same input gives the same bytes.
std::string IntrinsicsHtml(const std::vector<CameraIntrinsics>& cameras);

}  // namespace rgbdt
