#pragma once

#include <opencv2/core/mat.hpp>
#include <utility>

#include "calib/model/image.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// Throws InputError, with both values, for an image of another size or kind than the rig says, and
/// for pixels that are not of the image's own format.
void CheckImage(const CameraSpec& camera, const Image& image);

/// The same for the pixels alone. None at all, and compressed ones, are of no format.
void CheckPixels(const Image& image);

/// Grey values of any image as CV_32FC1 in the image's own units (DN or counts). A mosaic is
/// demosaiced first. Throws InputError for pixels that were not decompressed.
cv::Mat ToGrey(const Image& image);

/// A colour picture of any image, CV_8UC3 BGR: a mosaic demosaiced, 16-bit counts stretched.
/// Throws InputError for pixels that were not decompressed.
cv::Mat ToBgr(const Image& image);

/// Value of CV_32FC1 below which `fraction` (0 to 1) of the pixels lie, from every seventh pixel.
float Percentile(const cv::Mat& grey, double fraction);

/// What a picture of CV_32FC1 shows as black and as white: the 1st and the 99th percentile, as a
/// few dead or hot pixels are not to set the scale.
std::pair<float, float> StretchLimits(const cv::Mat& grey);

/// CV_32FC1 to CV_8UC1 between those, or between `limits`.
cv::Mat Stretch(const cv::Mat& grey);
cv::Mat Stretch(const cv::Mat& grey, const std::pair<float, float>& limits);

}  // namespace rgbdt
