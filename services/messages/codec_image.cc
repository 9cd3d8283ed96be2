#include <algorithm>
#include <cstring>
#include <limits>
#include <string>

#include "calib/model/errors.h"
#include "services/messages/check.h"
#include "services/messages/internal/codec_types.h"
#include "services/messages/internal/fields.h"
#include "services/messages/internal/image_file.h"

// 16-bit pixels are little-endian on the wire and copied as they are.
static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "16-bit pixels need swapping here");

namespace rgbdt {
namespace {

bool IsFile(PixelFormat format) {
  return format == PixelFormat::kJpeg || format == PixelFormat::kPng;
}

int MatType(PixelFormat format) {
  if (format == PixelFormat::kMono16) return CV_16UC1;
  return format == PixelFormat::kBgr8 ? CV_8UC3 : CV_8UC1;
}

int BytesPerPixel(PixelFormat format) { return static_cast<int>(CV_ELEM_SIZE(MatType(format))); }

PixelFormat FormatOf(const cv::Mat& pixels) {
  if (pixels.type() == CV_16UC1) return PixelFormat::kMono16;
  return pixels.type() == CV_8UC3 ? PixelFormat::kBgr8 : PixelFormat::kMono8;
}

void CopyRows(const cv::Mat& pixels, image_t* wire) {
  const auto row_bytes = static_cast<std::size_t>(pixels.cols) * pixels.elemSize();
  const auto rows = static_cast<std::size_t>(pixels.rows);
  if (rows * row_bytes > kMaxMessageBytes) {
    throw InputError("an image of " + std::to_string(pixels.cols) + " x " +
                     std::to_string(pixels.rows) + " px takes " + std::to_string(rows * row_bytes) +
                     " bytes; the bus carries " + std::to_string(kMaxMessageBytes) +
                     ": send raw Bayer, JPEG or PNG");
  }
  wire->stride = static_cast<std::int32_t>(row_bytes);
  wire->data.resize(rows * row_bytes);
  for (std::size_t row = 0; row < rows; ++row) {
    std::memcpy(wire->data.data() + row * row_bytes, pixels.ptr(static_cast<int>(row)), row_bytes);
  }
}

void Check(const radiometry_t& wire) {
  CheckRange("radiometry.kind", wire.kind, radiometry_t::NONE, radiometry_t::PLANCK);
  const double numbers[] = {
      wire.gain_k_per_count, wire.offset_k, wire.planck_r,   wire.planck_b,
      wire.planck_f,         wire.planck_o, wire.emissivity, wire.reflected_temperature_k};
  CheckFinite("radiometry", numbers, std::size(numbers));
  if (wire.kind == radiometry_t::NONE) return;
  if (wire.kind == radiometry_t::LINEAR && wire.gain_k_per_count == 0) {
    Fail("radiometry.gain_k_per_count", 0.0, "another number for LINEAR");
  }
  if (wire.kind == radiometry_t::PLANCK && (wire.planck_r <= 0 || wire.planck_b <= 0)) {
    Fail("radiometry.planck_r or planck_b", std::min(wire.planck_r, wire.planck_b),
         "a positive number for PLANCK");
  }
  if (wire.emissivity <= 0 || wire.emissivity > 1) {
    Fail("radiometry.emissivity", wire.emissivity, "above 0, 1 at most");
  }
  CheckNotNegative("radiometry.reflected_temperature_k", wire.reflected_temperature_k);
}

void CheckRawSize(const image_t& wire) {
  const auto format = static_cast<PixelFormat>(wire.pixel_format);
  const std::int64_t row_bytes = std::int64_t{wire.width} * BytesPerPixel(format);
  CheckRange("stride", wire.stride, row_bytes, std::numeric_limits<std::int32_t>::max());
  CheckRange("size", wire.size, std::int64_t{wire.stride} * wire.height,
             std::int64_t{wire.stride} * wire.height);
}

}  // namespace

template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, radiometry_t>& wire,
            StructOf<Copy, Radiometry>& radiometry) {
  copy(wire.kind, radiometry.kind);
  copy(wire.gain_k_per_count, radiometry.gain);
  copy(wire.offset_k, radiometry.offset);
  copy(wire.planck_r, radiometry.r);
  copy(wire.planck_b, radiometry.b);
  copy(wire.planck_f, radiometry.f);
  copy(wire.planck_o, radiometry.o);
  copy(wire.emissivity, radiometry.emissivity);
  copy(wire.reflected_temperature_k, radiometry.reflected_temperature_k);
}

// All but the pixels and the radiometry.
template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, image_t>& wire, StructOf<Copy, Image>& image) {
  copy(wire.utime, image.utime);
  copy(wire.seq, image.seq);
  copy(wire.camera, image.camera);
  copy(wire.frame_number, image.frame_number);
  copy(wire.device_utime, image.device_utime);
  copy(wire.exposure_s, image.exposure_s);
  copy(wire.pixel_format, image.format);
  copy(wire.shutter_correcting, image.shutter_correcting);
}

image_t ToWire(const Image& image) {
  auto wire = FieldsToWire<image_t>(image);
  wire.radiometry = FieldsToWire<radiometry_t>(image.radiometry);
  wire.width = image.pixels.cols;
  wire.height = image.pixels.rows;
  if (IsFile(image.format)) {
    wire.data = EncodeSentImage(image.pixels, image.format);
  } else if (image.pixels.type() != MatType(image.format)) {
    Fail("type of pixels", cv::typeToString(image.pixels.type()),
         cv::typeToString(MatType(image.format)) + " for pixel_format " +
             std::to_string(wire.pixel_format));
  } else {
    CopyRows(image.pixels, &wire);
  }
  wire.size = CountOf(wire.data.size(), "size");
  return wire;
}

void Check(const image_t& wire) {
  CheckUtime("utime", wire.utime);
  CheckCameraName("camera", wire.camera);
  CheckRange("frame_number", wire.frame_number, 0, std::numeric_limits<std::int64_t>::max());
  CheckNotNegative("exposure_s", wire.exposure_s);
  CheckRange("width", wire.width, 1, kMaxImageSide);
  CheckRange("height", wire.height, 1, kMaxImageSide);
  CheckRange("width * height", std::int64_t{wire.width} * wire.height, 1, kMaxPixels);
  CheckRange("pixel_format", wire.pixel_format, image_t::MONO8, image_t::PNG);
  Check(wire.radiometry);
  if (!IsFile(static_cast<PixelFormat>(wire.pixel_format))) CheckRawSize(wire);
}

Image FromWire(const image_t& wire) {
  auto image = FieldsFromWire<Image>(wire);
  // Without a conversion nothing else counts: senders may leave all at zero.
  if (wire.radiometry.kind != radiometry_t::NONE) {
    image.radiometry = FieldsFromWire<Radiometry>(wire.radiometry);
  }
  if (IsFile(image.format)) {
    image.pixels = DecodeSentImage(wire.data, image.format, wire.width, wire.height);
    image.format = FormatOf(image.pixels);
  } else {
    // The header does not own the bytes, hence the clone; it does not write to them either.
    image.pixels =
        cv::Mat(wire.height, wire.width, MatType(image.format),
                const_cast<std::uint8_t*>(wire.data.data()), static_cast<std::size_t>(wire.stride))
            .clone();
  }
  return image;
}

}  // namespace rgbdt
