#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>

#include "calib/model/image.h"

namespace rgbdt {

/// GenICam's pixel formats by their numbers (GenICam Pixel Format Naming Convention 2.1, table of
/// values), those that rgbdt-camera takes.
enum class GenicamFormat : std::uint32_t {
  kMono8 = 0x01080001,
  kMono10 = 0x01100003,
  kMono12 = 0x01100005,
  kMono14 = 0x01100025,
  kMono16 = 0x01100007,
  kMono12Packed = 0x010C0006,  // GigE Vision's own
  kMono12p = 0x010C0047,
  kBayerGr8 = 0x01080008,
  kBayerRg8 = 0x01080009,
  kBayerGb8 = 0x0108000A,
  kBayerBg8 = 0x0108000B,
  kRgb8 = 0x02180014,
  kBgr8 = 0x02180015,
};

/// GenICam's name of what a rig file calls BAYER_RG8 and so on.
std::string GenicamName(PixelFormat format);

/// A frame's own format and pixels.
struct Pixels {
  PixelFormat format = PixelFormat::kMono8;
  cv::Mat pixels;
};

/// The `size` bytes of a frame, copied. Sensors of 10 to 14 bits give kMono16 with their counts as
/// they are; what a device leaves in the bits above is cut off. Throws InputError for a format that
/// is none of the above, and for fewer bytes than width x height take.
Pixels PixelsOf(std::uint32_t format, const void* data, std::size_t size, int width, int height);

}  // namespace rgbdt
