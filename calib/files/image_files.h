#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>

#include "calib/model/image.h"

namespace rgbdt {

/// DecodeImage of a file. Throws InputError naming it where it cannot be read or decoded.
cv::Mat DecodeImageFile(const std::filesystem::path& path);

/// The first channel of a grey picture that was written as three (8 bit; alike to 8 counts, as JPEG
/// and video leave them); any other picture as it is.
cv::Mat OneChannelOfGrey(const cv::Mat& pixels);

/// `pixels` (8 or 16 bit; 1 or 3 channels) as the bytes of a PNG. `compression` 0 to 9; the default
/// is for speed: a raw camera image is mostly noise, and more takes seconds to save little.
std::string EncodePng(const cv::Mat& pixels, int compression = 1);

/// `pixels` (8 bit; 1 or 3 channels) as the bytes of a JPEG; `quality` 1 to 100.
std::string EncodeJpeg(const cv::Mat& pixels, int quality);

/// EncodePng into a file, atomically.
void WritePng(const std::filesystem::path& path, const cv::Mat& pixels);

/// 16 bits of a picture as 8, all by the power of two that makes its brightest pixel fit: sensors
/// of 10, 12 and 14 bits are sent in 16. Others stay as they are.
void EightBits(cv::Mat* pixels);

/// What `decoded` is: kMono8, kMono16 or kBgr8 by its type, or `declared` where that fits the type
/// (a raw mosaic is a grey image of which only the writer knows the pattern). Turns BGRA into BGR,
/// and colours and declared mosaics of 16 bit into 8. Throws InputError where the type is none of
/// these or contradicts `declared`; 0 is "not declared".
PixelFormat FormatOf(PixelFormat declared, cv::Mat* decoded);

/// BAYER_RG8 and so on, as the schemas name it.
std::string NameOf(PixelFormat format);

}  // namespace rgbdt
