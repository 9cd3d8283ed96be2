#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

namespace rgbdt {

/// Why nothing can be found in an image (CV_32FC1): it is empty, constant, or mostly at one end of
/// its range. Empty text: nothing speaks against it.
std::string WhyImageIsUseless(const cv::Mat& grey);

/// Pixels that stand out from all of their eight neighbours on the same side, by far more than the
/// image's noise, replaced by these neighbours' median: dead and hot pixels. Before, columns and
/// rows that stand out so from both beside them, in nine of ten pixels, by the mean of these.
/// CV_32FC1 in and out.
cv::Mat RepairDeadPixels(const cv::Mat& given);

/// Value of CV_32FC1 at a place [px], linear between pixels; NaN outside the image.
float Interpolate(const cv::Mat& grey, double x, double y);

}  // namespace rgbdt
