#include "calib/present/frames/image_frame.h"

#include <opencv2/core.hpp>

#include "calib/model/errors.h"
#include "tests/unit/matchers.h"
#include "tests/unit/present/frames/frame_testing.h"

namespace rgbdt {
namespace {

using testing::HasSubstr;

Image ImageOf(PixelFormat format, const cv::Mat& pixels) {
  Image image;
  image.camera = "eye";
  image.utime = 1'700'000'000'123'457;
  image.format = format;
  image.pixels = pixels;
  return image;
}

// A mosaic of one colour.
cv::Mat FlatBayerRg(int width, int height, int red, int green, int blue) {
  cv::Mat mosaic(height, width, CV_8UC1, cv::Scalar(green));
  for (int y = 0; y < height; y += 2) {
    for (int x = 0; x < width; x += 2) {
      mosaic.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(red);
      mosaic.at<std::uint8_t>(y + 1, x + 1) = static_cast<std::uint8_t>(blue);
    }
  }
  return mosaic;
}

// Left half and right half.
Image TwoTemperatures(int left, int right) {
  cv::Mat pixels(60, 80, CV_16UC1, cv::Scalar(left));
  pixels.colRange(40, 80) = cv::Scalar(right);
  return ImageOf(PixelFormat::kMono16, pixels);
}

TEST(ImageFrame, AMosaicIsShownInItsColoursAndShrunk) {
  const Image image = ImageOf(PixelFormat::kBayerRg8, FlatBayerRg(1600, 900, 200, 120, 40));
  const ParsedFrame frame = Parse(ImageFrame(image, "0003", true));
  EXPECT_EQ(frame.header.at("type"), "image");
  EXPECT_EQ(frame.header.at("camera"), "eye");
  EXPECT_EQ(frame.header.at("view"), "0003");
  EXPECT_EQ(frame.header.at("utime"), image.utime);
  EXPECT_EQ(frame.header.at("width"), 1600);
  EXPECT_EQ(frame.header.at("height"), 900);
  EXPECT_TRUE(frame.header.at("min_k").is_null());
  EXPECT_TRUE(frame.header.at("max_k").is_null());
  EXPECT_EQ(frame.header.at("ack"), true);
  const cv::Mat jpeg = frame.Jpeg();
  EXPECT_EQ(jpeg.size(), cv::Size(1280, 720));
  const cv::Vec3b middle = jpeg.at<cv::Vec3b>(360, 640);
  EXPECT_NEAR(middle[0], 40, 3);
  EXPECT_NEAR(middle[1], 120, 3);
  EXPECT_NEAR(middle[2], 200, 3);
}

TEST(ImageFrame, AnImageIsNeverWidened) {
  const Image image = ImageOf(PixelFormat::kMono8, cv::Mat(30, 40, CV_8UC1, cv::Scalar(77)));
  const cv::Mat jpeg = Parse(ImageFrame(image, "", false)).Jpeg();
  EXPECT_EQ(jpeg.size(), cv::Size(40, 30));
  EXPECT_NEAR(jpeg.at<std::uint8_t>(15, 20), 77, 2);  // not stretched
}

TEST(ImageFrame, ThermalGoesFromTheColdestToTheWarmestInKelvin) {
  Image image = TwoTemperatures(7000, 8000);
  image.radiometry.kind = Radiometry::Kind::kLinear;
  image.radiometry.gain = 0.04;
  image.radiometry.offset = 1.5;
  const ParsedFrame frame = Parse(ImageFrame(image, "", true));
  EXPECT_NEAR(frame.header.at("min_k").get<double>(), 281.5, 1e-9);
  EXPECT_NEAR(frame.header.at("max_k").get<double>(), 321.5, 1e-9);
  const cv::Mat jpeg = frame.Jpeg();
  EXPECT_EQ(jpeg.type(), CV_8UC1);
  EXPECT_LE(jpeg.at<std::uint8_t>(30, 10), 3);
  EXPECT_GE(jpeg.at<std::uint8_t>(30, 70), 252);
}

TEST(ImageFrame, CountsWithoutRadiometryAreShownWithoutKelvin) {
  const ParsedFrame frame = Parse(ImageFrame(TwoTemperatures(7000, 7010), "", true));
  EXPECT_TRUE(frame.header.at("min_k").is_null());
  EXPECT_TRUE(frame.header.at("max_k").is_null());
  EXPECT_GE(frame.Jpeg().at<std::uint8_t>(30, 70), 252);
}

TEST(ImageFrame, EightBitCountsWithRadiometryAreThermal) {
  Image image = ImageOf(PixelFormat::kMono8, cv::Mat(20, 20, CV_8UC1, cv::Scalar(100)));
  image.pixels.rowRange(0, 10) = cv::Scalar(50);
  image.radiometry.kind = Radiometry::Kind::kLinear;
  image.radiometry.gain = 0.4;
  image.radiometry.offset = 260;
  const nlohmann::json header = Parse(ImageFrame(image, "", true)).header;
  EXPECT_NEAR(header.at("min_k").get<double>(), 280, 1e-9);
  EXPECT_NEAR(header.at("max_k").get<double>(), 300, 1e-9);
}

TEST(ImageFrame, PixelsThatCannotBeShownAreNamed) {
  for (const auto& [format, type] :
       std::vector<std::pair<PixelFormat, int>>{{PixelFormat::kJpeg, CV_8UC1},
                                                {PixelFormat::kMono16, CV_8UC1},
                                                {PixelFormat::kBayerRg8, CV_8UC3}}) {
    const Image image = ImageOf(format, cv::Mat::zeros(4, 6, type));
    EXPECT_THAT(InputErrorOf([&] { ImageFrame(image, "", true); }), HasSubstr("\"eye\""));
    EXPECT_THAT(InputErrorOf([&] { ThumbFrame(image, ""); }), HasSubstr("\"eye\""));
  }
  const Image none = ImageOf(PixelFormat::kMono8, cv::Mat());
  EXPECT_THAT(InputErrorOf([&] { ImageFrame(none, "", true); }), HasSubstr("0x0"));
}

TEST(ThumbFrame, IsSmall) {
  const Image image = ImageOf(PixelFormat::kBayerRg8, FlatBayerRg(1600, 900, 200, 120, 40));
  const ParsedFrame frame = Parse(ThumbFrame(image, "0003"));
  EXPECT_EQ(frame.header.at("type"), "thumb");
  EXPECT_EQ(frame.header.at("camera"), "eye");
  EXPECT_EQ(frame.header.at("view"), "0003");
  EXPECT_EQ(frame.header.at("width"), 240);
  EXPECT_EQ(frame.header.at("height"), 135);
  EXPECT_EQ(frame.Jpeg().size(), cv::Size(240, 135));
}

}  // namespace
}  // namespace rgbdt
