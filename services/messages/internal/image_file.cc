#include "services/messages/internal/image_file.h"

#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "calib/model/errors.h"
#include "calib/model/image_codec.h"

namespace rgbdt {
namespace {

const char* NameOf(PixelFormat format) { return format == PixelFormat::kPng ? "PNG" : "JPEG"; }

bool IsOf(PixelFormat format, const std::vector<std::uint8_t>& bytes) {
  using namespace std::string_view_literals;
  const auto begin = format == PixelFormat::kPng ? "\x89PNG\r\n\x1a\n"sv : "\xff\xd8"sv;
  return std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size())
             .substr(0, begin.size()) == begin;
}

}  // namespace

cv::Mat DecodeSentImage(const std::vector<std::uint8_t>& bytes, PixelFormat format, int width,
                        int height) {
  const std::string name = NameOf(format);
  const auto size = IsOf(format, bytes) ? StatedSize(bytes.data(), bytes.size()) : std::nullopt;
  if (!size) throw InputError("data is no " + name + " file");
  if (size->width != width || size->height != height) {
    throw InputError("the " + name + " is " + std::to_string(size->width) + " x " +
                     std::to_string(size->height) + " px; the message says " +
                     std::to_string(width) + " x " + std::to_string(height));
  }
  cv::Mat pixels = DecodeImage(bytes.data(), bytes.size(), "the " + name);
  if (pixels.cols != width || pixels.rows != height) {
    throw InputError("the " + name + " cannot be decoded");
  }
  if (pixels.type() != CV_8UC1 && pixels.type() != CV_8UC3 && pixels.type() != CV_16UC1) {
    throw InputError("the " + name + " has " + std::to_string(pixels.channels()) + " channels of " +
                     std::to_string(8 * pixels.elemSize1()) +
                     " bits; expected 1 of 8 or 16, or 3 of 8");
  }
  return pixels;
}

std::vector<std::uint8_t> EncodeSentImage(const cv::Mat& pixels, PixelFormat format) {
  const bool sixteen = pixels.type() == CV_16UC1 && format == PixelFormat::kPng;
  if (pixels.empty() || (pixels.type() != CV_8UC1 && pixels.type() != CV_8UC3 && !sixteen)) {
    throw InputError(std::string("pixels of this type cannot be sent as ") + NameOf(format));
  }
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode(format == PixelFormat::kPng ? ".png" : ".jpg", pixels, bytes)) {
    throw InputError(std::string("pixels cannot be compressed to ") + NameOf(format));
  }
  return bytes;
}

}  // namespace rgbdt
