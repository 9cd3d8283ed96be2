#include "services/drivers/camera/internal/frame_format.h"

#include <cstdio>
#include <cstring>
#include <opencv2/imgproc.hpp>

#include "calib/model/errors.h"

namespace rgbdt {
namespace {

struct Layout {
  PixelFormat format;
  int bits;  // in memory, of a pixel
  int counts_bits;
};

Layout LayoutOf(std::uint32_t format) {
  switch (static_cast<GenicamFormat>(format)) {
    case GenicamFormat::kMono8:
      return {PixelFormat::kMono8, 8, 8};
    case GenicamFormat::kMono10:
      return {PixelFormat::kMono16, 16, 10};
    case GenicamFormat::kMono12:
      return {PixelFormat::kMono16, 16, 12};
    case GenicamFormat::kMono14:
      return {PixelFormat::kMono16, 16, 14};
    case GenicamFormat::kMono16:
      return {PixelFormat::kMono16, 16, 16};
    case GenicamFormat::kMono12Packed:
    case GenicamFormat::kMono12p:
      return {PixelFormat::kMono16, 12, 12};
    case GenicamFormat::kBayerGr8:
      return {PixelFormat::kBayerGr8, 8, 8};
    case GenicamFormat::kBayerRg8:
      return {PixelFormat::kBayerRg8, 8, 8};
    case GenicamFormat::kBayerGb8:
      return {PixelFormat::kBayerGb8, 8, 8};
    case GenicamFormat::kBayerBg8:
      return {PixelFormat::kBayerBg8, 8, 8};
    case GenicamFormat::kRgb8:
    case GenicamFormat::kBgr8:
      return {PixelFormat::kBgr8, 24, 8};
  }
  char digits[16];
  std::snprintf(digits, sizeof digits, "0x%08X", format);
  throw InputError(std::string("the camera sends pixel format ") + digits +
                   ", which is not known here; set PixelFormat to BayerRG8, Mono8, Mono14, Mono16 "
                   "or RGB8 in the rig file");
}

void RequireBytes(std::size_t have, std::size_t need, int width, int height) {
  if (have >= need) return;
  throw InputError("a frame of " + std::to_string(width) + " x " + std::to_string(height) +
                   " px has " + std::to_string(have) + " bytes; expected " + std::to_string(need));
}

// Two pixels in three bytes.
void Unpack12(GenicamFormat format, const std::uint8_t* bytes, std::size_t pixels,
              std::uint16_t* out) {
  const bool gige = format == GenicamFormat::kMono12Packed;
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::uint8_t* three = bytes + i / 2 * 3;
    const int low = three[1] & 15;
    const int high = three[1] >> 4;
    // GigE Vision: the middle byte holds both pixels' low bits. GenICam's "p": bits in their order.
    const int even = gige ? three[0] << 4 | low : three[0] | low << 8;
    const int odd = gige ? three[2] << 4 | high : high | three[2] << 4;
    out[i] = static_cast<std::uint16_t>(i % 2 == 0 ? even : odd);
  }
}

}  // namespace

std::string GenicamName(PixelFormat format) {
  switch (format) {
    case PixelFormat::kMono16:
      return "Mono16";
    case PixelFormat::kBayerRg8:
      return "BayerRG8";
    case PixelFormat::kBayerGr8:
      return "BayerGR8";
    case PixelFormat::kBayerGb8:
      return "BayerGB8";
    case PixelFormat::kBayerBg8:
      return "BayerBG8";
    case PixelFormat::kBgr8:
      return "BGR8";
    case PixelFormat::kMono8:
    case PixelFormat::kJpeg:
    case PixelFormat::kPng:
      break;
  }
  return "Mono8";
}

Pixels PixelsOf(std::uint32_t format, const void* data, std::size_t size, int width, int height) {
  const Layout layout = LayoutOf(format);
  if (width < 1 || height < 1) {
    throw InputError("a frame is " + std::to_string(width) + " x " + std::to_string(height) +
                     " px");
  }
  const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  const std::size_t pairs = (pixels + 1) / 2;
  const std::size_t bytes =
      layout.bits == 12 ? 3 * pairs : pixels * static_cast<std::size_t>(layout.bits) / 8;
  RequireBytes(size, bytes, width, height);
  const int type = layout.format == PixelFormat::kMono16 ? CV_16UC1
                   : layout.format == PixelFormat::kBgr8 ? CV_8UC3
                                                         : CV_8UC1;
  Pixels out{layout.format, cv::Mat(height, width, type)};
  if (layout.bits == 12) {
    // The last pair may be half: it is read whole from the packed bytes, which hold it.
    Unpack12(static_cast<GenicamFormat>(format), static_cast<const std::uint8_t*>(data), pixels,
             out.pixels.ptr<std::uint16_t>());
    return out;
  }
  std::memcpy(out.pixels.data, data, bytes);
  if (static_cast<GenicamFormat>(format) == GenicamFormat::kRgb8) {
    cv::cvtColor(out.pixels, out.pixels, cv::COLOR_RGB2BGR);
  }
  if (layout.format == PixelFormat::kMono16 && layout.counts_bits < 16) {
    cv::bitwise_and(out.pixels, cv::Scalar((1 << layout.counts_bits) - 1), out.pixels);
  }
  return out;
}

}  // namespace rgbdt
