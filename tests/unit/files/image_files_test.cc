#include "calib/files/image_files.h"

#include <opencv2/imgcodecs.hpp>

#include "calib/files/atomic_file.h"
#include "calib/model/image_codec.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using namespace std::string_literals;
using ::testing::HasSubstr;

bool Same(const cv::Mat& a, const cv::Mat& b) {
  return a.type() == b.type() && a.size() == b.size() &&
         cv::norm(a.reshape(1), b.reshape(1), cv::NORM_INF) == 0;
}

cv::Mat Random(int type) {
  cv::Mat image(17, 23, type);
  cv::randu(image, 0, image.depth() == CV_8U ? 256 : 65536);
  return image;
}

TEST(ImageFiles, PngGivesBackEveryPixel) {
  const test::TempDir dir;
  for (const int type : {CV_8UC1, CV_16UC1, CV_8UC3, CV_16UC3}) {
    const cv::Mat image = Random(type);
    WritePng(dir / "a.png", image);
    EXPECT_TRUE(Same(DecodeImageFile(dir / "a.png"), image)) << "OpenCV type " << type;
  }
}

TEST(ImageFiles, RefusesWhatAPngCannotHold) {
  const test::TempDir dir;
  EXPECT_THAT(test::ErrorOf([&] { WritePng(dir / "a.png", cv::Mat(3, 4, CV_32FC1)); }),
              HasSubstr("4x3"));
  test::ErrorOf([&] { WritePng(dir / "a.png", cv::Mat()); });
  EXPECT_FALSE(std::filesystem::exists(dir / "a.png"));
}

TEST(ImageFiles, AJpegIsNearlyTheSamePicture) {
  for (const int type : {CV_8UC1, CV_8UC3}) {
    cv::Mat image(40, 60, type, cv::Scalar(40, 90, 200));
    image.colRange(0, 30) = cv::Scalar(200, 60, 30);
    const std::string good = EncodeJpeg(image, 95);
    const cv::Mat back = DecodeImage(good.data(), good.size(), "a.jpg");
    ASSERT_EQ(back.type(), type);
    ASSERT_EQ(back.size(), image.size());
    EXPECT_LT(cv::norm(back.colRange(0, 24), image.colRange(0, 24), cv::NORM_INF), 6);
    EXPECT_LT(EncodeJpeg(image, 20).size(), good.size());
  }
  EXPECT_THAT(test::ErrorOf([] { EncodeJpeg(cv::Mat(3, 4, CV_16UC1), 90); }), HasSubstr("4x3"));
  test::ErrorOf([] { EncodeJpeg(cv::Mat(), 90); });
}

TEST(ImageFiles, FormatFollowsTheTypeOrWhatIsTold) {
  const auto format = [](int type, PixelFormat told = PixelFormat{}) {
    cv::Mat image = Random(type);
    return FormatOf(told, &image);
  };
  EXPECT_EQ(format(CV_8UC1), PixelFormat::kMono8);
  EXPECT_EQ(format(CV_16UC1), PixelFormat::kMono16);
  EXPECT_EQ(format(CV_8UC3), PixelFormat::kBgr8);
  EXPECT_EQ(format(CV_8UC4), PixelFormat::kBgr8);
  EXPECT_EQ(format(CV_8UC1, PixelFormat::kBayerGb8), PixelFormat::kBayerGb8);
  EXPECT_THAT(test::ErrorOf([&] { format(CV_8UC3, PixelFormat::kBayerGb8); }),
              HasSubstr("BAYER_GB8"));
  EXPECT_EQ(format(CV_16UC3), PixelFormat::kBgr8);
  EXPECT_EQ(format(CV_16UC4), PixelFormat::kBgr8);
  EXPECT_EQ(format(CV_16UC1, PixelFormat::kBayerGb8), PixelFormat::kBayerGb8);
  EXPECT_THAT(test::ErrorOf([&] { format(CV_32FC1); }), HasSubstr("32-bit float"));
}

TEST(ImageFiles, SixteenBitsBecomeEightByTheSensorsBits) {
  const auto brightest = [](int count) {
    cv::Mat image(1, 2, CV_16UC3, cv::Scalar(count, count / 2, 0));
    EightBits(&image);
    return image.at<cv::Vec3b>(0);
  };
  EXPECT_EQ(brightest(0xffff), cv::Vec3b(255, 128, 0));
  EXPECT_EQ(brightest(0x3fff), cv::Vec3b(255, 128, 0)) << "14 bits";
  EXPECT_EQ(brightest(0xfff), cv::Vec3b(255, 128, 0)) << "12 bits";
  EXPECT_EQ(brightest(0x3ff), cv::Vec3b(255, 128, 0)) << "10 bits";
  EXPECT_EQ(brightest(255), cv::Vec3b(255, 127, 0));
}

TEST(ImageFiles, DamagedFilesNeverCrashAndAreNamed) {
  const auto parse = [](const std::string& bytes) {
    DecodeImage(bytes.data(), bytes.size(), "a.png");
  };
  const std::string png = EncodePng(Random(CV_16UC1));
  test::ParseTruncations(png, parse);
  test::ParseDamaged(png, parse, 100);
  std::vector<unsigned char> jpeg;
  cv::imencode(".jpg", Random(CV_8UC3), jpeg);
  test::ParseTruncations({jpeg.begin(), jpeg.end()}, parse, 100);
  EXPECT_THAT(test::ErrorOf([&] { parse("not an image"); }), HasSubstr("a.png"));
  EXPECT_THAT(test::ErrorOf([&] { parse(""); }), HasSubstr("empty"));
  EXPECT_THAT(test::ErrorOf([&] { parse(png.substr(0, png.size() / 2)); }), HasSubstr("cut short"));
}

TEST(ImageFiles, AForgedSizeIsAnError) {
  std::string png = EncodePng(Random(CV_8UC1));
  for (std::size_t i = 16; i < 24; ++i) png[i] = '\x7f';  // width and height in the header
  EXPECT_THAT(test::ErrorOf([&] { DecodeImage(png.data(), png.size(), "huge.png"); }),
              HasSubstr("huge.png"));
}

// A few hundred kilobytes that unpack to gigabytes.
TEST(ImageFiles, WhatUnpacksToTooManyPixelsIsRefusedByItsHeader) {
  const cv::Mat black = cv::Mat::zeros(12'000, 12'000, CV_8UC1);
  const std::string png = EncodePng(black, 9);
  ASSERT_LT(png.size(), 1'000'000u);
  EXPECT_THAT(test::ErrorOf([&] { DecodeImage(png.data(), png.size(), "bomb.png"); }),
              AllOf(HasSubstr("bomb.png"), HasSubstr("12000x12000"), HasSubstr("134217728")));
  std::string jpeg = EncodeJpeg(cv::Mat::zeros(64, 48, CV_8UC1), 90);
  const std::size_t frame = jpeg.find("\xFF\xC0");
  ASSERT_NE(frame, std::string::npos);
  for (std::size_t i = 5; i < 9; ++i) jpeg[frame + i] = '\x7f';  // height and width
  EXPECT_THAT(test::ErrorOf([&] { DecodeImage(jpeg.data(), jpeg.size(), "bomb.jpg"); }),
              AllOf(HasSubstr("bomb.jpg"), HasSubstr("32639x32639")));
}

// A decoder passes over codes without a length, to the header of a large image; by a length we
// would pass over that one, to the header of a small image.
TEST(ImageFiles, AJpegWhoseHeaderCanBeReadInTwoWaysIsRefused) {
  const std::string jpeg = EncodeJpeg(cv::Mat::zeros(64, 48, CV_8UC1), 90);
  const std::string large = "\xFF\xC0"s + "\0\x0B\x08\x7f\x7f\x7f\x7f\x01\x01\x11\0"s;
  ASSERT_TRUE(StatedSize(jpeg.data(), jpeg.size()));
  for (const char code : "\x01\xD0\xD7\xD8\xD9\xDA"s + '\0') {
    const std::string head = "\xFF\xD8\xFF"s + code + '\0' + static_cast<char>(2 + large.size());
    const std::string two = head + large + jpeg.substr(2);
    EXPECT_FALSE(StatedSize(two.data(), two.size())) << static_cast<int>(code);
    EXPECT_THAT(test::ErrorOf([&] { DecodeImage(two.data(), two.size(), "two.jpg"); }),
                HasSubstr("two.jpg cannot be decoded"));
  }
}

// OpenCV would take gigabytes at their word.
TEST(ImageFiles, EveryFormatTellsItsSizeBeforeItIsUnpacked) {
  const auto encoded = [](const std::string& extension) {
    std::vector<unsigned char> bytes;
    cv::imencode(extension, Random(extension == ".pgm" ? CV_8UC1 : CV_8UC3), bytes);
    return std::string(bytes.begin(), bytes.end());
  };
  for (const std::string extension : {".png", ".jpg", ".tif", ".bmp", ".pgm", ".ppm"}) {
    const std::string bytes = encoded(extension);
    const auto said = StatedSize(bytes.data(), bytes.size());
    ASSERT_TRUE(said) << extension;
    EXPECT_EQ(said->width, 23) << extension;
    EXPECT_EQ(said->height, 17) << extension;
    EXPECT_EQ(DecodeImage(bytes.data(), bytes.size(), "a").cols, 23) << extension;
  }
  const auto error = [](const std::string& bytes) {
    return test::ErrorOf([&] { DecodeImage(bytes.data(), bytes.size(), "bomb"); });
  };
  EXPECT_THAT(error("P5\n# a comment\n60000 50000\n255\n"), HasSubstr("60000x50000"));
  EXPECT_THAT(error("P5 99999999999999999999 1\n255\n"), HasSubstr("expected at most 134217728"));
  std::string bmp = encoded(".bmp");
  bmp.replace(18, 8, std::string("\0\0\1\0\0\0\xff\xff", 8));  // 65536, and -65536: downwards
  EXPECT_THAT(error(bmp), HasSubstr("65536x65536"));
  const std::string tiff("II*\0\x08\0\0\0\2\0\0\1\4\0\1\0\0\0\0\0\1\0\1\1\4\0\1\0\0\0\0\0\1\0", 34);
  EXPECT_THAT(error(tiff), HasSubstr("65536x65536"));
  EXPECT_THAT(error(encoded(".webp")), HasSubstr("expected a PNG, JPEG, TIFF, BMP or PNM"));
}

// Each of these took OpenCV half a second.
TEST(ImageFiles, AnImageThatItsFewBytesCannotHoldIsNotUnpacked) {
  // One strip or tile of zeros by deflate: 11536x11536 pixels.
  const auto tiff = [](const std::string& sides) {
    const auto entry = [](const std::string& tag, char value_low, char value_high = 0) {
      return tag + "\4\0\1\0\0\0"s + value_low + value_high + "\0\0"s;
    };
    return "II*\0\x08\0\0\0\x09\0"s + sides + entry("\x02\1"s, 8) + entry("\x03\1"s, 8) +
           entry("\x06\1"s, 1) + entry("\x11\1"s, '\x7a') + entry("\x15\1"s, 1) +
           entry("\x16\1"s, '\x10', '\x2d') + entry("\x17\1"s, 12) + "\0\0\0\0"s +
           "\x78\x9c\x63\x60\0\0\0\x01\0\x01"s;
  };
  const std::string side = "\4\0\1\0\0\0\x10\x2d\0\0"s;
  const std::string strip = tiff("\0\1"s + side + "\1\1"s + side);
  const std::string jpeg = EncodeJpeg(cv::Mat::zeros(64, 48, CV_8UC1), 90);
  std::string large_jpeg = jpeg;
  const std::size_t frame = jpeg.find("\xFF\xC0"s);
  ASSERT_NE(frame, std::string::npos);
  for (const std::size_t i : {5, 7}) large_jpeg.replace(frame + i, 2, "\x2d\x10"s);
  for (const std::string& bytes : {strip, large_jpeg}) {
    EXPECT_THAT(test::ErrorOf([&] { DecodeImage(bytes.data(), bytes.size(), "bomb"); }),
                HasSubstr("11536x11536 pixels, which its " + std::to_string(bytes.size()) +
                          " bytes cannot hold"));
  }
}

// As few bytes as a picture of one colour has.
TEST(ImageFiles, APictureOfOneColourIsRead) {
  for (const std::string extension : {".png", ".jpg", ".tif"}) {
    std::vector<unsigned char> bytes;
    cv::imencode(extension, cv::Mat::zeros(1456, 1936, CV_8UC1), bytes,
                 {cv::IMWRITE_PNG_COMPRESSION, 9, cv::IMWRITE_PNG_BILEVEL, 1,
                  cv::IMWRITE_JPEG_OPTIMIZE, 1, cv::IMWRITE_JPEG_QUALITY, 1});
    EXPECT_EQ(DecodeImage(bytes.data(), bytes.size(), "a").cols, 1936) << extension;
  }
}

}  // namespace
}  // namespace rgbdt
