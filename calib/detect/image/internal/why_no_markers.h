#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "calib/detect/image/internal/marker_decode.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// Why the markers of an image (CV_32FC1) are not the target's, in words: of another family,
/// mirrored, laid out otherwise, or none.
std::string WhyNoMarkers(const cv::Mat& grey, const Target& target,
                         const std::vector<SeenMarker>& seen);

/// Numbers that the target has not, of more markers than chance decodes; empty: there are none.
std::string WhyNotThisBoard(const Target& target, const std::vector<SeenMarker>& seen);

}  // namespace rgbdt
