#include "calib/camera/packed.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "calib/camera/pixels.h"
#include "calib/model/errors.h"

namespace rgbdt {
namespace {

Image Of(PixelFormat format, int type) {
  Image image;
  image.format = format;
  image.pixels = cv::Mat(4, 6, type, cv::Scalar(7));
  image.pixels.row(0).setTo(90);
  return image;
}

bool Same(const cv::Mat& a, const cv::Mat& b) {
  return a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

TEST(Packed, CountsLoseNothing) {
  const Image counts = Of(PixelFormat::kMono16, CV_16UC1), packed = Packed(counts);
  EXPECT_EQ(packed.format, PixelFormat::kPng);
  EXPECT_TRUE(Same(packed.pixels, counts.pixels));
}

TEST(Packed, AMosaicBecomesAColourPicture) {
  const Image mosaic = Of(PixelFormat::kBayerRg8, CV_8UC1);
  EXPECT_EQ(Packed(mosaic).format, PixelFormat::kJpeg);
  EXPECT_TRUE(Same(Packed(mosaic).pixels, ToBgr(mosaic)));
  EXPECT_EQ(Packed(mosaic, PixelFormat::kPng).format, PixelFormat::kPng);
  EXPECT_TRUE(Same(Packed(mosaic, PixelFormat::kPng).pixels, ToBgr(mosaic)));
}

TEST(Packed, CountsAsJpegAreAPicture) {
  const Image counts = Of(PixelFormat::kMono16, CV_16UC1);
  EXPECT_TRUE(Same(Packed(counts, PixelFormat::kJpeg).pixels, ToBgr(counts)));
}

TEST(Packed, WhatIsPackedAlreadyIsRefused) {
  EXPECT_THROW(Packed(Of(PixelFormat::kJpeg, CV_8UC3)), InputError);
}

}  // namespace
}  // namespace rgbdt
