#include "services/import/image_data.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "calib/files/image_files.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using testing::HasSubstr;

constexpr Utime kStamp = 1'700'000'000'000'000;

ros::Image RosImage(const std::string& encoding, std::uint32_t width, std::uint32_t height,
                    std::uint32_t step, const std::string& bytes) {
  ros::Image image;
  image.header.utime = kStamp;
  image.encoding = encoding;
  image.width = width;
  image.height = height;
  image.step = step;
  image.data = reinterpret_cast<const std::uint8_t*>(bytes.data());
  image.size = bytes.size();
  return image;
}

TEST(RosPixels, RowsMayBePadded) {
  const std::string bytes = "ab__cd__";
  const Image image = ToImage(RosImage("bayer_grbg8", 2, 2, 4, bytes), "/cam");
  EXPECT_EQ(image.format, PixelFormat::kBayerGr8);
  EXPECT_EQ(image.utime, kStamp);
  EXPECT_EQ(cv::countNonZero(image.pixels != (cv::Mat_<std::uint8_t>(2, 2) << 'a', 'b', 'c', 'd')),
            0);
}

TEST(RosPixels, ColoursComeInOpenCvsOrder) {
  const std::string rgb = {1, 2, 3}, bgra = {3, 2, 1, 9}, uyvy = {'\x80', 50, '\x80', 60};
  EXPECT_EQ(ToImage(RosImage("rgb8", 1, 1, 3, rgb), "").pixels.at<cv::Vec3b>(0),
            cv::Vec3b(3, 2, 1));
  EXPECT_EQ(ToImage(RosImage("bgra8", 1, 1, 4, bgra), "").pixels.at<cv::Vec3b>(0),
            cv::Vec3b(3, 2, 1));
  const cv::Mat grey = ToImage(RosImage("yuv422", 2, 1, 4, uyvy), "").pixels;
  EXPECT_EQ(grey.at<cv::Vec3b>(0)[0], grey.at<cv::Vec3b>(0)[2]);
  EXPECT_GT(grey.at<cv::Vec3b>(1)[0], grey.at<cv::Vec3b>(0)[0]);
}

TEST(RosPixels, SixteenBitsOfEitherByteOrder) {
  const std::string bytes = {1, 2};
  ros::Image image = RosImage("mono16", 1, 1, 2, bytes);
  EXPECT_EQ(ToImage(image, "").pixels.at<std::uint16_t>(0), 0x0201);
  image.big_endian = true;
  EXPECT_EQ(ToImage(image, "").pixels.at<std::uint16_t>(0), 0x0102);
}

TEST(RosPixels, WhatCannotBeIsRefused) {
  const std::string bytes(8, 'x');
  const auto error = [&](const ros::Image& image) {
    return test::ErrorOf([&] { ToImage(image, "/cam"); });
  };
  EXPECT_THAT(error(RosImage("64FC1", 1, 1, 8, bytes)), HasSubstr("/cam: encoding \"64FC1\""));
  EXPECT_THAT(error(RosImage("nv12", 2, 4, 2, bytes)), HasSubstr("cut short: 6 rows of 2 bytes"));
  EXPECT_THAT(error(RosImage("nv12", 2, 3, 2, bytes)), HasSubstr("odd width or height"));
  EXPECT_THAT(error(RosImage("32FC1", 1, 1, 6, bytes)), HasSubstr("a multiple of 4"));
  EXPECT_THAT(error(RosImage("mono8", 2, 5, 2, bytes)), HasSubstr("cut short"));
  EXPECT_THAT(error(RosImage("mono8", 2, 2, 1, bytes)), HasSubstr("cut short"));
  EXPECT_THAT(error(RosImage("mono8", 0, 2, 0, bytes)), HasSubstr("0 x 2 px"));
  EXPECT_THAT(error(RosImage("mono8", 4'000'000'000U, 4'000'000'000U, 4'000'000'000U, bytes)),
              HasSubstr("px; expected"));
  EXPECT_THAT(error(RosImage("yuv422", 1, 1, 2, bytes)), HasSubstr("odd width"));
  EXPECT_THAT(error(RosImage("mono16", 1, 2, 3, bytes)), HasSubstr("even number"));
}

ros::CompressedImage Compressed(const std::string& format, const std::string& bytes) {
  ros::CompressedImage image;
  image.format = format;
  image.data = reinterpret_cast<const std::uint8_t*>(bytes.data());
  image.size = bytes.size();
  return image;
}

TEST(RosPixels, PngKeepsItsBits) {
  const cv::Mat counts = (cv::Mat_<std::uint16_t>(1, 2) << 7, 40000);
  const std::string bytes = EncodePng(counts);
  const Image image = ToImage(Compressed("mono16; png compressed mono16", bytes), "");
  EXPECT_EQ(image.format, PixelFormat::kMono16);
  EXPECT_EQ(image.pixels.at<std::uint16_t>(1), 40000);
  const std::string mosaic = EncodePng(cv::Mat(2, 2, CV_8UC1, cv::Scalar(9)));
  EXPECT_EQ(ToImage(Compressed("bayer_rggb8; png compressed bayer_rggb8", mosaic), "").format,
            PixelFormat::kBayerRg8);
  EXPECT_EQ(ToImage(Compressed("png", mosaic), "").format, PixelFormat::kMono8);
}

// A few bytes may claim gigabytes.
TEST(RosPixels, AnImageThatClaimsTooMuchIsNotDecoded) {
  std::string bytes = EncodePng(cv::Mat(2, 2, CV_8UC1, cv::Scalar(9)));
  bytes[18] = '\x4e';  // 19970 x 19970: each side is allowed, so many pixels are not
  bytes[22] = '\x4e';
  EXPECT_THAT(test::ErrorOf([&] { ToImage(Compressed("png", bytes), "/cam"); }),
              HasSubstr("/cam: is 19970 x 19970 px; expected"));
  EXPECT_THAT(test::ErrorOf([&] { ToImage(Compressed("compressedDepth", "12345678"), "/cam"); }),
              HasSubstr("expected JPEG, PNG or TIFF"));
}

// Of one colour, in each encoding that tells it; nothing may change red and blue over.
TEST(RosPixels, EachEncodingTellsTheSameColour) {
  const auto text = [](const std::vector<int>& bytes) {
    return std::string(bytes.begin(), bytes.end());
  };
  // Red: Y 82, U 90, V 240 (ITU-R BT.601).
  const std::vector<std::pair<std::string, std::vector<int>>> red = {
      {"uyvy", {90, 82, 240, 82, 90, 82, 240, 82}},
      {"yuv422", {90, 82, 240, 82, 90, 82, 240, 82}},
      {"yuyv", {82, 90, 82, 240, 82, 90, 82, 240}},
      {"yuv422_yuy2", {82, 90, 82, 240, 82, 90, 82, 240}},
      {"nv12", {82, 82, 82, 82, 90, 240}},
      {"NV21", {82, 82, 82, 82, 240, 90}}};
  for (const auto& [encoding, bytes] : red) {
    const std::string sent = text(bytes);
    const bool packed = bytes.size() == 8;
    const Image image = ToImage(RosImage(encoding, 2, 2, packed ? 4 : 2, sent), "");
    ASSERT_EQ(image.format, PixelFormat::kBgr8) << encoding;
    ASSERT_EQ(image.pixels.size(), cv::Size(2, 2)) << encoding;
    for (const cv::Vec3b& pixel : cv::Mat_<cv::Vec3b>(image.pixels)) {
      EXPECT_LT(cv::norm(cv::Vec3d(pixel) - cv::Vec3d(0, 0, 255)), 5) << encoding;
    }
  }
}

TEST(RosPixels, ColoursOfSixteenBitBecomeEight) {
  const std::string bytes = {'\0', '\x40', '\0', '\x20', '\0', '\x10', '\xff', '\x7f'};
  const auto pixel = [&](const std::string& encoding, std::uint32_t step, bool big = false) {
    std::string sent = bytes;
    for (std::size_t i = 0; big && i < sent.size(); i += 2) std::swap(sent[i], sent[i + 1]);
    ros::Image image = RosImage(encoding, 1, 1, step, sent);
    image.big_endian = big;
    return ToImage(image, "").pixels.at<cv::Vec3b>(0);
  };
  EXPECT_EQ(pixel("rgb16", 6), cv::Vec3b(0x10, 0x20, 0x40));
  EXPECT_EQ(pixel("bgr16", 6), cv::Vec3b(0x40, 0x20, 0x10));
  EXPECT_EQ(pixel("16UC3", 6), cv::Vec3b(0x40, 0x20, 0x10));
  EXPECT_EQ(pixel("rgba16", 8), cv::Vec3b(0x10, 0x20, 0x40));
  EXPECT_EQ(pixel("rgba16", 8, true), cv::Vec3b(0x10, 0x20, 0x40));
  EXPECT_EQ(pixel("bgra16", 8), cv::Vec3b(0x40, 0x20, 0x10));
}

TEST(RosPixels, AMosaicOfSixteenBitKeepsItsPattern) {
  const std::string bytes = {1, 0, 0, 4, 2, 8, 3, 12};  // a sensor of 12 bits
  ros::Image image = RosImage("bayer_gbrg16", 2, 2, 4, bytes);
  const Image out = ToImage(image, "");
  EXPECT_EQ(out.format, PixelFormat::kBayerGb8);
  EXPECT_EQ(cv::countNonZero(out.pixels != (cv::Mat_<std::uint8_t>(2, 2) << 0, 64, 128, 192)), 0);
}

TEST(RosPixels, SpellingsOfAnEncodingAreOne) {
  const std::string bytes(12, 'x');
  using F = PixelFormat;
  const std::vector<std::pair<std::string, F>> spellings = {
      {"BayerRG8", F::kBayerRg8},    {"BayerGR8", F::kBayerGr8},    {"BayerGB8", F::kBayerGb8},
      {"BayerBG8", F::kBayerBg8},    {"bayer_bggr8", F::kBayerBg8}, {"BAYER_RGGB8", F::kBayerRg8},
      {"bayer_grbg8", F::kBayerGr8}, {"Mono8", F::kMono8},          {"8uc1", F::kMono8}};
  for (const auto& [name, format] : spellings) {
    EXPECT_EQ(ToImage(RosImage(name, 2, 2, 2, bytes), "").format, format) << name;
  }
  EXPECT_EQ(ToImage(RosImage("BayerRG16", 2, 2, 4, bytes), "").format, F::kBayerRg8);
  EXPECT_THAT(test::ErrorOf([&] { ToImage(RosImage("bayer_rg", 2, 2, 2, bytes), ""); }),
              HasSubstr("is not read"));
}

// A plane of temperatures, or of depth.
struct Floats {
  explicit Floats(float from, float to) {
    for (int i = 0; i < 400; ++i)
      values.push_back(from + (to - from) * static_cast<float>(i) / 400);
  }
  ros::Image Sent(bool big_endian = false) {
    bytes.assign(reinterpret_cast<const char*>(values.data()), 4 * values.size());
    for (std::size_t i = 0; big_endian && i < bytes.size(); i += 4) {
      std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(i),
                   bytes.begin() + static_cast<std::ptrdiff_t>(i + 4));
    }
    ros::Image image = RosImage("32FC1", 20, 20, 80, bytes);
    image.big_endian = big_endian;
    return image;
  }
  std::vector<float> values;
  std::string bytes;
};

TEST(RosPixels, TemperaturesBecomeCountsOfAHundredthKelvin) {
  for (const bool big_endian : {false, true}) {
    Floats kelvin(280, 310), celsius(-5, 36);
    EXPECT_EQ(FloatUnitOf(kelvin.Sent(big_endian)), FloatUnit::kKelvin);
    EXPECT_EQ(FloatUnitOf(celsius.Sent(big_endian)), FloatUnit::kMaybeCelsius);
    const Image of_kelvin = ToImage(kelvin.Sent(big_endian), "");
    EXPECT_EQ(of_kelvin.format, PixelFormat::kMono16);
    EXPECT_EQ(of_kelvin.pixels.at<std::uint16_t>(0, 0), 28000);
    EXPECT_EQ(of_kelvin.radiometry.kind, Radiometry::Kind::kLinear);
    EXPECT_EQ(of_kelvin.radiometry.gain, 0.01);
    EXPECT_EQ(of_kelvin.radiometry.offset, 0);
    EXPECT_EQ(ToImage(celsius.Sent(big_endian), "").pixels.at<std::uint16_t>(0, 0), 26815);
  }
  Floats dead(280, 310);
  dead.values[7] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(ToImage(dead.Sent(), "").pixels.at<std::uint16_t>(0, 7), 0);
}

TEST(RosPixels, DepthIsNoTemperature) {
  for (const float none : {0.F, std::numeric_limits<float>::quiet_NaN()}) {
    Floats depth(0.5, 12);
    for (std::size_t i = 0; i < 20; ++i) depth.values[20 * i] = none;
    EXPECT_EQ(FloatUnitOf(depth.Sent()), FloatUnit::kNone);
    EXPECT_THAT(test::ErrorOf([&] { ToImage(depth.Sent(), "/cam"); }),
                HasSubstr("/cam: numbers of floating point"));
  }
  EXPECT_EQ(FloatUnitOf(Floats(500, 4000).Sent()), FloatUnit::kNone) << "millimetres";
  EXPECT_EQ(FloatUnitOf(RosImage("mono8", 1, 1, 1, "x")), FloatUnit::kNone);
}

}  // namespace
}  // namespace rgbdt
