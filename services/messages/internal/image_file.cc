#include "services/messages/internal/image_file.h"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <string>

#include "calib/model/errors.h"
#include "calib/model/image_codec.h"

namespace rgbdt {
namespace {

const char* NameOf(PixelFormat format) { return format == PixelFormat::kPng ? "PNG" : "JPEG"; }

// Big-endian, `count` bytes; the caller has looked that they are there.
unsigned BigEndian(const std::vector<std::uint8_t>& bytes, std::size_t at, int count) {
  unsigned value = 0;
  for (int i = 0; i < count; ++i) value = value << 8 | bytes[at + static_cast<std::size_t>(i)];
  return value;
}

struct Size {
  unsigned width = 0, height = 0;
};

// Signature, then the chunk IHDR: length, name, width, height.
std::optional<Size> PngSize(const std::vector<std::uint8_t>& bytes) {
  static constexpr std::uint8_t kSignature[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  if (bytes.size() < 24 || !std::equal(std::begin(kSignature), std::end(kSignature), bytes.begin()))
    return std::nullopt;
  return Size{BigEndian(bytes, 16, 4), BigEndian(bytes, 20, 4)};
}

// Segments of marker (ff xx), length and contents, until the frame's: c0 to cf but for three.
std::optional<Size> JpegSize(const std::vector<std::uint8_t>& bytes) {
  if (bytes.size() < 4 || bytes[0] != 0xff || bytes[1] != 0xd8) return std::nullopt;
  std::size_t at = 2;
  while (at + 9 <= bytes.size() && bytes[at] == 0xff) {
    const std::uint8_t marker = bytes[at + 1];
    if (marker == 0xff) {  // fill
      ++at;
      continue;
    }
    const bool frame =
        marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
    if (frame) return Size{BigEndian(bytes, at + 7, 2), BigEndian(bytes, at + 5, 2)};
    at += 2 + BigEndian(bytes, at + 2, 2);
  }
  return std::nullopt;
}

}  // namespace

cv::Mat DecodeSentImage(const std::vector<std::uint8_t>& bytes, PixelFormat format, int width,
                        int height) {
  const std::string name = NameOf(format);
  const std::optional<Size> size = format == PixelFormat::kPng ? PngSize(bytes) : JpegSize(bytes);
  if (!size) throw InputError("data is no " + name + " file");
  if (size->width != static_cast<unsigned>(width) ||
      size->height != static_cast<unsigned>(height)) {
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
