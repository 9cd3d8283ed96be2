#include "calib/files/image_files.h"

#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "calib/files/atomic_file.h"
#include "calib/model/errors.h"
#include "calib/model/image_codec.h"

namespace rgbdt {
namespace {

std::string Describe(const cv::Mat& image) {
  static const char* const kDepths[] = {"8-bit",         "signed 8-bit",  "16-bit",
                                        "signed 16-bit", "signed 32-bit", "32-bit float",
                                        "64-bit float",  "16-bit float"};
  return std::to_string(image.channels()) + "-channel " + kDepths[image.depth()];
}

int TypeOf(PixelFormat format) {
  switch (format) {
    case PixelFormat::kMono16:
      return CV_16UC1;
    case PixelFormat::kBgr8:
      return CV_8UC3;
    case PixelFormat::kJpeg:
    case PixelFormat::kPng:
      return -1;
    default:
      return CV_8UC1;
  }
}

[[noreturn]] void Refuse(const cv::Mat& pixels, const std::string& format,
                         const std::string& bits) {
  throw InputError("cannot write a " + format + " of a " + std::to_string(pixels.cols) + "x" +
                   std::to_string(pixels.rows) + " image of OpenCV type " +
                   std::to_string(pixels.type()) + "; expected " + bits + " with 1 or 3 channels");
}

std::string Encode(const std::string& extension, const cv::Mat& pixels,
                   const std::vector<int>& options) {
  std::vector<unsigned char> bytes;
  if (!cv::imencode(extension, pixels, bytes, options)) {
    throw InputError("OpenCV could not encode the image as " + extension);
  }
  return {bytes.begin(), bytes.end()};
}

}  // namespace

cv::Mat DecodeImageFile(const std::filesystem::path& path) {
  const std::string bytes = ReadWholeFile(path, kMostImageBytes);
  return DecodeImage(bytes.data(), bytes.size(), path.string());
}

cv::Mat OneChannelOfGrey(const cv::Mat& pixels) {
  constexpr double kAlike = 8;
  if (pixels.type() != CV_8UC3 && pixels.type() != CV_8UC4) return pixels;
  std::vector<cv::Mat> channels;
  cv::split(pixels, channels);
  for (int c : {1, 2}) {
    if (cv::norm(channels[0], channels[static_cast<std::size_t>(c)], cv::NORM_INF) > kAlike) {
      return pixels;
    }
  }
  return channels[1];
}

std::string EncodePng(const cv::Mat& pixels, int compression) {
  const int depth = pixels.depth();
  const int channels = pixels.channels();
  if (pixels.empty() || (depth != CV_8U && depth != CV_16U) || (channels != 1 && channels != 3)) {
    Refuse(pixels, "PNG", "8 or 16 bit");
  }
  return Encode(".png", pixels, {cv::IMWRITE_PNG_COMPRESSION, compression});
}

std::string EncodeJpeg(const cv::Mat& pixels, int quality) {
  if (pixels.empty() || (pixels.type() != CV_8UC1 && pixels.type() != CV_8UC3)) {
    Refuse(pixels, "JPEG", "8 bit");
  }
  return Encode(".jpg", pixels, {cv::IMWRITE_JPEG_QUALITY, quality});
}

void WritePng(const std::filesystem::path& path, const cv::Mat& pixels) {
  WriteFileAtomically(path, EncodePng(pixels));
}

void EightBits(cv::Mat* pixels) {
  if (pixels->depth() != CV_16U) return;
  double brightest = 0;
  cv::minMaxIdx(pixels->reshape(1), nullptr, &brightest);
  int bits = 8;
  while (brightest >= std::ldexp(1, bits)) bits += 2;
  cv::Mat eight;
  pixels->convertTo(eight, CV_8U, std::ldexp(1, 8 - bits));
  *pixels = eight;
}

PixelFormat FormatOf(PixelFormat declared, cv::Mat* decoded) {
  const bool mosaic = declared >= PixelFormat::kBayerRg8 && declared <= PixelFormat::kBayerBg8;
  if (decoded->channels() > 1 || mosaic) EightBits(decoded);
  if (decoded->type() == CV_8UC4) {
    cv::Mat bgr;
    cv::cvtColor(*decoded, bgr, cv::COLOR_BGRA2BGR);
    *decoded = bgr;
  }
  if (declared != PixelFormat{}) {
    if (TypeOf(declared) == decoded->type()) return declared;
    throw InputError("is a " + Describe(*decoded) + " image, which is not " + NameOf(declared));
  }
  for (const PixelFormat format : {PixelFormat::kMono8, PixelFormat::kMono16, PixelFormat::kBgr8}) {
    if (TypeOf(format) == decoded->type()) return format;
  }
  throw InputError("is a " + Describe(*decoded) +
                   " image; expected 8-bit grey, Bayer mosaic or colour, or 16-bit grey");
}

std::string NameOf(PixelFormat format) {
  switch (format) {
    case PixelFormat::kMono8:
      return "MONO8";
    case PixelFormat::kMono16:
      return "MONO16";
    case PixelFormat::kBayerRg8:
      return "BAYER_RG8";
    case PixelFormat::kBayerGr8:
      return "BAYER_GR8";
    case PixelFormat::kBayerGb8:
      return "BAYER_GB8";
    case PixelFormat::kBayerBg8:
      return "BAYER_BG8";
    case PixelFormat::kBgr8:
      return "BGR8";
    case PixelFormat::kJpeg:
      return "JPEG";
    case PixelFormat::kPng:
      return "PNG";
  }
  return "pixel format " + std::to_string(static_cast<int>(format));
}

}  // namespace rgbdt
