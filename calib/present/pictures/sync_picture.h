#pragma once

#include <opencv2/core/mat.hpp>

#include "calib/sync/sync.h"

namespace rgbdt {

/// Each camera's time offset over time, about its mean, with 1 sigma: a chart for each camera of
/// which one is given. 8-bit BGR. Empty where there is none.
cv::Mat SyncPicture(const SyncResult& result);

}  // namespace rgbdt
