#pragma once

#include <string>

#include "calib/model/image.h"
#include "services/import/ros_messages.h"

namespace rgbdt {

/// The pixels as they were sent, in OpenCV's order, of either byte order: mono8 mono16 8UC1 16UC1;
/// bgr8 rgb8 bgra8 rgba8 8UC3 8UC4; bayer_*8; YUV 4:2:2 (uyvy, yuyv) and 4:2:0 (nv12, nv21), whose
/// rows of colour follow those of brightness. Capitals and - and _ do not count; GenICam's names
/// (BayerRG8) mean the same. Colours and mosaics of 16 bit become 8 (EightBits). 32FC1 of
/// temperatures becomes kMono16 of 0.01 K, with that radiometry; not a number is 0. Throws
/// InputError, which begins with `where`: other encodings, and 32FC1 that is no temperature.
Image ToImage(const ros::Image& image, const std::string& where);

/// The same of JPEG, PNG and TIFF; a mosaic in a PNG stays one. `utime` is the header's.
Image ToImage(const ros::CompressedImage& image, const std::string& where);

/// What numbers of floating point (32FC1) may be. Metres of depth and degrees Celsius are alike.
enum class FloatUnit {
  kNone,          ///< no such image, or neither
  kKelvin,        ///< all but outliers are 200 to 700
  kMaybeCelsius,  ///< -60 to 200, and hardly any is exactly 0 or not a number, as of depth
};
FloatUnit FloatUnitOf(const ros::Image& image);

}  // namespace rgbdt
