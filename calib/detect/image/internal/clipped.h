#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "calib/model/image.h"

namespace rgbdt {

inline constexpr std::uint8_t kClippedBright = 255;
inline constexpr std::uint8_t kClippedDark = 1;

/// Where an image ends at its brightest or darkest value: CV_8U of kClippedBright, kClippedDark and
/// 0. An edge beside such pixels is not where it seems, since one side of its blur is cut off.
/// Bright: 8 bits, 250 and above in any channel, and what is demosaiced from such; 16 bits, the
/// very brightest value, where more than 100 pixels have it. Dark: more than a tenth of the pixels
/// in 7 x 7 have the value 0, which lifts the mean of a noisy black.
cv::Mat Clipped(const Image& image);

}  // namespace rgbdt
