#include "calib/camera/packed.h"

#include <utility>

#include "calib/camera/pixels.h"

namespace rgbdt {
namespace {

bool IsGrey(PixelFormat format) {
  return format == PixelFormat::kMono8 || format == PixelFormat::kMono16;
}

}  // namespace

Image Packed(Image image, PixelFormat format) {
  if (format != PixelFormat::kPng || !IsGrey(image.format)) image.pixels = ToBgr(image);
  image.format = format;
  return image;
}

Image Packed(Image image) {
  const PixelFormat format = IsGrey(image.format) ? PixelFormat::kPng : PixelFormat::kJpeg;
  return Packed(std::move(image), format);
}

}  // namespace rgbdt
