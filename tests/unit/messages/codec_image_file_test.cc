#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "calib/model/errors.h"
#include "services/messages/codec.h"
#include "services/messages/internal/codec_types.h"

namespace rgbdt {
namespace {

using ::testing::HasSubstr;

Image Ramp(int type, PixelFormat format) {
  Image image;
  image.camera = "rgb";
  image.utime = 1;
  image.format = format;
  image.pixels.create(40, 60, type);
  for (int row = 0; row < 40; ++row) {
    for (int column = 0; column < 60; ++column) {
      image.pixels(cv::Rect(column, row, 1, 1)).setTo(cv::Scalar(2 * row, 3 * column, 100));
    }
  }
  return image;
}

Image ThroughTheWire(const Image& image) {
  const Bytes bytes = Encode(image);
  return std::get<Image>(Decode("RGB_IMAGE", bytes.data(), bytes.size()));
}

double Difference(const Image& a, const Image& b) {
  return cv::norm(a.pixels, b.pixels, cv::NORM_INF);
}

TEST(ImageFile, PngIsDecodedOnReceiptExactly) {
  const Image gray = ThroughTheWire(Ramp(CV_8UC1, PixelFormat::kPng));
  EXPECT_EQ(gray.format, PixelFormat::kMono8);
  EXPECT_EQ(Difference(gray, Ramp(CV_8UC1, PixelFormat::kMono8)), 0);
  const Image color = ThroughTheWire(Ramp(CV_8UC3, PixelFormat::kPng));
  EXPECT_EQ(color.format, PixelFormat::kBgr8);
  EXPECT_EQ(Difference(color, Ramp(CV_8UC3, PixelFormat::kBgr8)), 0);
  const Image thermal = ThroughTheWire(Ramp(CV_16UC1, PixelFormat::kPng));
  EXPECT_EQ(thermal.format, PixelFormat::kMono16);
  EXPECT_EQ(Difference(thermal, Ramp(CV_16UC1, PixelFormat::kMono16)), 0);
}

TEST(ImageFile, JpegIsDecodedOnReceiptNearly) {
  const Image color = ThroughTheWire(Ramp(CV_8UC3, PixelFormat::kJpeg));
  EXPECT_EQ(color.format, PixelFormat::kBgr8);
  EXPECT_LT(Difference(color, Ramp(CV_8UC3, PixelFormat::kBgr8)), 12);
  EXPECT_EQ(ThroughTheWire(Ramp(CV_8UC1, PixelFormat::kJpeg)).format, PixelFormat::kMono8);
}

TEST(ImageFile, WhatCannotBeCompressedIsRefused) {
  EXPECT_THROW(Encode(Ramp(CV_16UC1, PixelFormat::kJpeg)), InputError);
  EXPECT_THROW(Encode(Ramp(CV_32FC1, PixelFormat::kPng)), InputError);
  EXPECT_THROW(Encode(Ramp(CV_8UC4, PixelFormat::kPng)), InputError);
  Image empty = Ramp(CV_8UC1, PixelFormat::kPng);
  empty.pixels.release();
  EXPECT_THROW(Encode(empty), InputError);
}

std::string ErrorAfter(PixelFormat format, void (*change)(image_t*)) {
  const Bytes good = Encode(Ramp(CV_8UC3, format));
  image_t wire;
  wire.decode(good.data(), 0, static_cast<int>(good.size()));
  change(&wire);
  wire.size = static_cast<std::int32_t>(wire.data.size());
  Bytes bytes(static_cast<std::size_t>(wire.getEncodedSize()));
  wire.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  try {
    Decode("RGB_IMAGE", bytes.data(), bytes.size());
  } catch (const InputError& e) {
    return e.what();
  }
  return "no error";
}

TEST(ImageFile, BrokenFilesAreNamed) {
  const PixelFormat png = PixelFormat::kPng;
  const PixelFormat jpeg = PixelFormat::kJpeg;
  EXPECT_THAT(ErrorAfter(png, [](image_t* w) { w->data.clear(); }), HasSubstr("no PNG file"));
  EXPECT_THAT(ErrorAfter(jpeg, [](image_t* w) { w->data.clear(); }), HasSubstr("no JPEG file"));
  EXPECT_THAT(ErrorAfter(jpeg, [](image_t* w) { w->data.resize(10); }), HasSubstr("no JPEG file"));
  EXPECT_THAT(ErrorAfter(png, [](image_t* w) { w->data.resize(60); }), HasSubstr("cannot be"));
  EXPECT_THAT(ErrorAfter(png, [](image_t* w) { w->width = 59; }), HasSubstr("60 x 40 px"));
  EXPECT_THAT(ErrorAfter(jpeg, [](image_t* w) { w->height = 41; }), HasSubstr("60 x 40 px"));
  EXPECT_THAT(ErrorAfter(jpeg, [](image_t* w) { w->pixel_format = image_t::PNG; }),
              HasSubstr("no PNG file"));
}

// A head that claims 19999 x 19999 pixels in a message of a few hundred bytes.
TEST(ImageFile, PictureThatWouldFillTheMemoryIsRefusedByItsHead) {
  EXPECT_THAT(ErrorAfter(PixelFormat::kPng, [](image_t* w) { w->width = w->height = 19999; }),
              HasSubstr("width * height"));
  EXPECT_THAT(ErrorAfter(PixelFormat::kPng, [](image_t* w) { w->data[17] = 0x7f; }),
              HasSubstr("the message says 60 x 40"));
}

}  // namespace
}  // namespace rgbdt
