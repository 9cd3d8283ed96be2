#include "services/import/image_data.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "calib/files/image_files.h"
#include "calib/model/errors.h"
#include "calib/model/image_codec.h"
#include "calib/model/text.h"
#include "services/bags/printable.h"

namespace rgbdt {
namespace {

constexpr std::int64_t kMostSide = 20000;  // [px]
constexpr std::int64_t kMostPixels = std::int64_t{1} << 26;

// How an encoding lies in memory, and what it becomes.
struct Encoding {
  int type;  // OpenCV's
  PixelFormat format;
  int conversion = -1;  // cv::ColorConversionCodes; -1: as it is
};

const std::map<std::string, Encoding>& Encodings() {
  using F = PixelFormat;
  static const std::map<std::string, Encoding> encodings = {
      {"mono8", {CV_8UC1, F::kMono8}},
      {"8uc1", {CV_8UC1, F::kMono8}},
      {"mono16", {CV_16UC1, F::kMono16}},
      {"16uc1", {CV_16UC1, F::kMono16}},
      {"32fc1", {CV_32FC1, F::kMono16}},
      {"bgr8", {CV_8UC3, F::kBgr8}},
      {"8uc3", {CV_8UC3, F::kBgr8}},
      {"rgb8", {CV_8UC3, F::kBgr8, cv::COLOR_RGB2BGR}},
      {"bgra8", {CV_8UC4, F::kBgr8, cv::COLOR_BGRA2BGR}},
      {"8uc4", {CV_8UC4, F::kBgr8, cv::COLOR_BGRA2BGR}},
      {"rgba8", {CV_8UC4, F::kBgr8, cv::COLOR_RGBA2BGR}},
      {"bgr16", {CV_16UC3, F::kBgr8}},
      {"16uc3", {CV_16UC3, F::kBgr8}},
      {"rgb16", {CV_16UC3, F::kBgr8, cv::COLOR_RGB2BGR}},
      {"bgra16", {CV_16UC4, F::kBgr8, cv::COLOR_BGRA2BGR}},
      {"16uc4", {CV_16UC4, F::kBgr8, cv::COLOR_BGRA2BGR}},
      {"rgba16", {CV_16UC4, F::kBgr8, cv::COLOR_RGBA2BGR}},
      {"bayerrggb8", {CV_8UC1, F::kBayerRg8}},
      {"bayergrbg8", {CV_8UC1, F::kBayerGr8}},
      {"bayergbrg8", {CV_8UC1, F::kBayerGb8}},
      {"bayerbggr8", {CV_8UC1, F::kBayerBg8}},
      {"bayerrggb16", {CV_16UC1, F::kBayerRg8}},
      {"bayergrbg16", {CV_16UC1, F::kBayerGr8}},
      {"bayergbrg16", {CV_16UC1, F::kBayerGb8}},
      {"bayerbggr16", {CV_16UC1, F::kBayerBg8}},
      {"yuv422", {CV_8UC2, F::kBgr8, cv::COLOR_YUV2BGR_UYVY}},
      {"uyvy", {CV_8UC2, F::kBgr8, cv::COLOR_YUV2BGR_UYVY}},
      {"yuv422yuy2", {CV_8UC2, F::kBgr8, cv::COLOR_YUV2BGR_YUY2}},
      {"yuyv", {CV_8UC2, F::kBgr8, cv::COLOR_YUV2BGR_YUY2}},
      {"yuy2", {CV_8UC2, F::kBgr8, cv::COLOR_YUV2BGR_YUY2}},
      {"nv12", {CV_8UC1, F::kBgr8, cv::COLOR_YUV2BGR_NV12}},
      {"nv21", {CV_8UC1, F::kBgr8, cv::COLOR_YUV2BGR_NV21}},
  };
  return encodings;
}

// "BayerRG8" (GenICam), "bayer_rggb8" (ROS): "bayerrggb8".
std::string Normalised(const std::string& name) {
  std::string plain;
  for (const char c : ToLower(name)) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) plain += c;
  }
  static const std::map<std::string, std::string> mosaics = {
      {"bayerrg", "gb"}, {"bayergr", "bg"}, {"bayergb", "rg"}, {"bayerbg", "gr"}};
  constexpr std::size_t kFirstRow = 7;
  const auto mosaic = mosaics.find(plain.substr(0, kFirstRow));
  const bool short_name = mosaic != mosaics.end() && plain.size() > kFirstRow &&
                          std::isdigit(static_cast<unsigned char>(plain[kFirstRow])) != 0;
  return short_name ? plain.insert(kFirstRow, mosaic->second) : plain;
}

const Encoding* FindEncoding(const std::string& name) {
  const auto found = Encodings().find(Normalised(name));
  return found == Encodings().end() ? nullptr : &found->second;
}

const Encoding& EncodingOf(const std::string& name, const std::string& where) {
  if (const Encoding* encoding = FindEncoding(name)) return *encoding;
  std::string known;
  for (const auto& entry : Encodings()) known += " " + entry.first;
  throw InputError(where + ": encoding \"" + Printable(name) +
                   "\" is not read; those that are:" + known);
}

void CheckSize(std::int64_t width, std::int64_t height, const std::string& where) {
  const bool good = width >= 1 && height >= 1 && width <= kMostSide && height <= kMostSide &&
                    width * height <= kMostPixels;
  if (good) return;
  throw InputError(where + ": is " + std::to_string(width) + " x " + std::to_string(height) +
                   " px; expected 1 to " + std::to_string(kMostSide) + ", and at most " +
                   std::to_string(kMostPixels) + " pixels");
}

bool IsYuv420(const Encoding& encoding) {
  return encoding.conversion == cv::COLOR_YUV2BGR_NV12 ||
         encoding.conversion == cv::COLOR_YUV2BGR_NV21;
}

void SwapBytes(cv::Mat* pixels) {
  const std::size_t bytes = pixels->elemSize1();
  const std::size_t row = static_cast<std::size_t>(pixels->cols) * pixels->elemSize();
  for (int y = 0; y < pixels->rows; ++y) {
    auto* const begin = pixels->ptr<std::uint8_t>(y);
    for (std::size_t at = 0; at < row; at += bytes) std::reverse(begin + at, begin + at + bytes);
  }
}

// The message's rows, those of colour included, in this machine's byte order.
cv::Mat PixelsOf(const ros::Image& image, const Encoding& encoding, const std::string& where) {
  CheckSize(image.width, image.height, where);
  const std::size_t row = image.width * static_cast<std::size_t>(CV_ELEM_SIZE(encoding.type));
  const bool halved = CV_MAT_CN(encoding.type) == 2 || IsYuv420(encoding);
  if (halved && (image.width % 2 != 0 || (IsYuv420(encoding) && image.height % 2 != 0))) {
    throw InputError(where + ": " + Printable(image.encoding) + " of an odd width or height, " +
                     std::to_string(image.width) + " x " + std::to_string(image.height));
  }
  const std::size_t size1 = CV_ELEM_SIZE1(encoding.type);
  if (image.step % size1 != 0) {
    throw InputError(where + ": rows of " + std::to_string(8 * size1) + "-bit pixels are " +
                     std::to_string(image.step) + " bytes apart; expected " +
                     (size1 == 2 ? "an even number" : "a multiple of 4"));
  }
  const std::size_t rows = IsYuv420(encoding) ? image.height / 2 * std::size_t{3} : image.height;
  if (image.step < row || image.size / image.step < rows) {
    throw InputError(where + ": is cut short: " + std::to_string(rows) + " rows of " +
                     std::to_string(row) + " bytes, " + std::to_string(image.step) +
                     " apart, are announced, " + std::to_string(image.size) + " bytes are there");
  }
  cv::Mat pixels = cv::Mat(static_cast<int>(rows), static_cast<int>(image.width), encoding.type,
                           const_cast<std::uint8_t*>(image.data), image.step)
                       .clone();
  if (image.big_endian) SwapBytes(&pixels);
  return pixels;
}

FloatUnit FloatUnitOf(const cv::Mat& numbers) {
  constexpr std::size_t kMostLooked = 1'000'000, kMostWithout = 100;  // one in a hundred
  const std::size_t step = 1 + numbers.total() / kMostLooked;
  std::vector<float> values;
  std::size_t without = 0;  // of depth there is none at many pixels
  for (std::size_t i = 0; i < numbers.total(); i += step) {
    const float value = numbers.ptr<float>()[i];
    if (std::isfinite(value) && value != 0) {
      values.push_back(value);
    } else {
      ++without;
    }
  }
  if (without * kMostWithout > values.size()) return FloatUnit::kNone;
  const auto part = [&](std::size_t percent) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() * percent / 100);
    std::nth_element(values.begin(), at, values.end());
    return *at;
  };
  const float low = part(1), high = part(99);
  if (low >= 200 && high <= 700) return FloatUnit::kKelvin;
  if (low >= -60 && high < 200) return FloatUnit::kMaybeCelsius;
  return FloatUnit::kNone;
}

// As counts of 0.01 K.
Image FromTemperatures(const cv::Mat& numbers, const std::string& where) {
  constexpr double kKelvinPerCount = 0.01, kZeroCelsius = 273.15;
  const FloatUnit unit = FloatUnitOf(numbers);
  if (unit == FloatUnit::kNone) {
    throw InputError(where +
                     ": numbers of floating point (32FC1) that are no temperatures: expected 200 "
                     "to 700 K or -60 to 200 degrees Celsius at 99 of 100 pixels, none of them "
                     "exactly 0 or not a number");
  }
  const double offset = unit == FloatUnit::kKelvin ? 0 : kZeroCelsius;
  Image out;
  numbers.convertTo(out.pixels, CV_16U, 1 / kKelvinPerCount, offset / kKelvinPerCount);
  out.pixels.setTo(0, numbers != numbers);  // not a number
  out.format = PixelFormat::kMono16;
  out.radiometry.kind = Radiometry::Kind::kLinear;
  out.radiometry.gain = kKelvinPerCount;
  return out;
}

// "bayer_rggb8; png compressed bayer_rggb8": what the pixels were before.
PixelFormat MosaicOf(const std::string& format) {
  const Encoding* before = FindEncoding(format.substr(0, format.find(';')));
  const bool mosaic = before != nullptr && before->format >= PixelFormat::kBayerRg8 &&
                      before->format <= PixelFormat::kBayerBg8;
  return mosaic ? before->format : PixelFormat{};
}

}  // namespace

Image ToImage(const ros::Image& image, const std::string& where) {
  const Encoding& encoding = EncodingOf(image.encoding, where);
  cv::Mat pixels = PixelsOf(image, encoding, where);
  Image out;
  if (encoding.type == CV_32FC1) {
    out = FromTemperatures(pixels, where);
  } else {
    out.format = encoding.format;
    if (out.format != PixelFormat::kMono16) EightBits(&pixels);
    if (encoding.conversion < 0) {
      out.pixels = pixels;
    } else {
      cv::cvtColor(pixels, out.pixels, encoding.conversion);
    }
  }
  out.utime = image.header.utime;
  return out;
}

Image ToImage(const ros::CompressedImage& image, const std::string& where) {
  const auto size = StatedSize(image.data, image.size);
  if (!size) {
    throw InputError(where + ": format \"" + Printable(image.format) +
                     "\" is not read; expected JPEG, PNG or TIFF");
  }
  CheckSize(size->width, size->height, where);
  Image out;
  out.utime = image.header.utime;
  out.pixels = rgbdt::DecodeImage(image.data, image.size, where);
  const bool grey = out.pixels.channels() == 1;
  out.format = FormatOf(grey ? MosaicOf(image.format) : PixelFormat{}, &out.pixels);
  return out;
}

FloatUnit FloatUnitOf(const ros::Image& image) {
  const Encoding* encoding = FindEncoding(image.encoding);
  if (encoding == nullptr || encoding->type != CV_32FC1) return FloatUnit::kNone;
  return FloatUnitOf(PixelsOf(image, *encoding, "image"));
}

}  // namespace rgbdt
