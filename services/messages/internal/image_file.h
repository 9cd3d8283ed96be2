#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "calib/model/image.h"

namespace rgbdt {

/// Decodes a JPEG or PNG of exactly width x height. The size is read from the file's head first:
/// a PNG of a few kilobytes may claim gigabytes. Gives CV_8UC1, CV_16UC1 or CV_8UC3; throws
/// InputError otherwise. EXIF rotation is ignored: pixels stay where the sensor has them.
cv::Mat DecodeSentImage(const std::vector<std::uint8_t>& bytes, PixelFormat format, int width,
                        int height);

/// Compresses CV_8UC1, CV_8UC3 or (PNG) CV_16UC1. Throws InputError for anything else.
std::vector<std::uint8_t> EncodeSentImage(const cv::Mat& pixels, PixelFormat format);

}  // namespace rgbdt
