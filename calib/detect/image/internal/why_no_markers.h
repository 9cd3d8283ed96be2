#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calib/detect/image/internal/marker_decode.h"
#include "calib/detect/image/internal/marker_layout.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// Why the markers of an image (CV_32FC1) are not the target's, in words: of another family,
/// mirrored, laid out otherwise, or none.
std::string WhyNoMarkers(const cv::Mat& grey, const Target& target,
                         const std::vector<SeenMarker>& seen);

/// The layout as OpenCV drew ChArUco before 4.6 where the target says from 4.6 on, and the other
/// way round: all markers but those at the rows' ends are one column off. Nothing of a grid of
/// markers.
std::optional<MarkerLayout> LayOutOtherWay(const Target& target,
                                           const std::vector<SeenMarker>& seen);
/// That the markers lie so, in words.
std::string WhyOtherWay(const Target& target);

/// Numbers that the target has not, of more markers than chance decodes; empty: there are none.
std::string WhyNotThisBoard(const Target& target, const std::vector<SeenMarker>& seen);

}  // namespace rgbdt
