#include "services/drivers/camera/internal/frame_format.h"

#include <gmock/gmock.h>

#include <opencv2/core.hpp>

#include "calib/model/errors.h"

namespace rgbdt {
namespace {

using ::testing::HasSubstr;

template <typename T>
Pixels Of(GenicamFormat format, const std::vector<T>& data, int width, int height) {
  return PixelsOf(static_cast<std::uint32_t>(format), data.data(), data.size() * sizeof(T), width,
                  height);
}

TEST(FrameFormat, Mono14KeepsItsCountsAndNothingAbove) {
  const std::vector<std::uint16_t> counts = {0, 1, 0x3FFF, 0xC005, 8191, 4000};
  const Pixels pixels = Of(GenicamFormat::kMono14, counts, 3, 2);
  EXPECT_EQ(pixels.format, PixelFormat::kMono16);
  ASSERT_EQ(pixels.pixels.type(), CV_16UC1);
  EXPECT_EQ(pixels.pixels.at<std::uint16_t>(0, 2), 0x3FFF);
  EXPECT_EQ(pixels.pixels.at<std::uint16_t>(1, 0), 5);
  EXPECT_EQ(pixels.pixels.at<std::uint16_t>(1, 1), 8191);
}

TEST(FrameFormat, Mono16KeepsAllBits) {
  const Pixels pixels = Of<std::uint16_t>(GenicamFormat::kMono16, {0xFFFF, 0x8001}, 2, 1);
  EXPECT_EQ(pixels.pixels.at<std::uint16_t>(0, 0), 0xFFFF);
  EXPECT_EQ(pixels.pixels.at<std::uint16_t>(0, 1), 0x8001);
}

// Bytes as the standards draw them: two pixels, 0xABC and 0x123.
TEST(FrameFormat, BothWaysOfPackingTwelveBits) {
  const Pixels gige = Of<std::uint8_t>(GenicamFormat::kMono12Packed, {0xAB, 0x3C, 0x12}, 2, 1);
  EXPECT_EQ(gige.pixels.at<std::uint16_t>(0, 0), 0xABC);
  EXPECT_EQ(gige.pixels.at<std::uint16_t>(0, 1), 0x123);
  const Pixels genicam = Of<std::uint8_t>(GenicamFormat::kMono12p, {0xBC, 0x3A, 0x12}, 2, 1);
  EXPECT_EQ(genicam.pixels.at<std::uint16_t>(0, 0), 0xABC);
  EXPECT_EQ(genicam.pixels.at<std::uint16_t>(0, 1), 0x123);
}

TEST(FrameFormat, RgbBecomesBgr) {
  const Pixels pixels = Of<std::uint8_t>(GenicamFormat::kRgb8, {10, 20, 30}, 1, 1);
  EXPECT_EQ(pixels.format, PixelFormat::kBgr8);
  EXPECT_EQ(pixels.pixels.at<cv::Vec3b>(0, 0), cv::Vec3b(30, 20, 10));
}

TEST(FrameFormat, EachMosaicKeepsItsName) {
  for (const auto& [genicam, ours] : {std::pair{GenicamFormat::kBayerRg8, PixelFormat::kBayerRg8},
                                      {GenicamFormat::kBayerGr8, PixelFormat::kBayerGr8},
                                      {GenicamFormat::kBayerGb8, PixelFormat::kBayerGb8},
                                      {GenicamFormat::kBayerBg8, PixelFormat::kBayerBg8}}) {
    EXPECT_EQ(Of<std::uint8_t>(genicam, {1, 2, 3, 4}, 2, 2).format, ours);
  }
  EXPECT_EQ(GenicamName(PixelFormat::kBayerRg8), "BayerRG8");
  EXPECT_EQ(GenicamName(PixelFormat::kMono16), "Mono16");
}

std::string ErrorOf(std::uint32_t format, std::size_t bytes) {
  const std::vector<char> data(bytes);
  try {
    PixelsOf(format, data.data(), data.size(), 4, 4);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(FrameFormat, FewerBytesThanPixelsAndUnknownFormatsAreNamed) {
  EXPECT_THAT(ErrorOf(static_cast<std::uint32_t>(GenicamFormat::kMono16), 31),
              HasSubstr("4 x 4 px has 31 bytes; expected 32"));
  EXPECT_THAT(ErrorOf(static_cast<std::uint32_t>(GenicamFormat::kMono12p), 23),
              HasSubstr("expected 24"));
  EXPECT_THAT(ErrorOf(0x02100032, 32), HasSubstr("pixel format 0x02100032, which is not known"));
}

}  // namespace
}  // namespace rgbdt
