#pragma once

#include <opencv2/core/mat.hpp>

#include "calib/model/calibration.h"

namespace rgbdt {

/// What the LIDAR is off by, as one camera's solve has it: charts by ring, by intensity and by what
/// lies beyond a board's edge, each with 1 sigma. 8-bit BGR, legible on a phone. Empty where the
/// solve took the LIDAR for exact.
cv::Mat LidarPicture(const CameraReport& camera);

/// How to read it, in words.
inline constexpr const char* kLidarCaption =
    "What the LIDAR is off by, found along with the pose; the bars are 1 sigma. By ring and by "
    "intensity: true range less measured range, beyond what all ranges have in common; a chart "
    "that "
    "is missing was not asked for by the views: rings agree, or brightness does not count. By "
    "edge: "
    "how much larger a board looks at each side than it is, by what lies beyond it; a beam is a "
    "few "
    "milliradians wide and returns what its stronger part meets.";

}  // namespace rgbdt
