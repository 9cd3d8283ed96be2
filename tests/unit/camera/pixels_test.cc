#include "calib/camera/pixels.h"

#include <opencv2/imgproc.hpp>

#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

using testing::AllOf;
using testing::HasSubstr;

CameraSpec SpecOf(CameraKind kind, int width, int height) {
  CameraSpec spec;
  spec.name = kind == CameraKind::kThermal ? "thermal" : "rgb";
  spec.kind = kind;
  spec.width = width;
  spec.height = height;
  return spec;
}

Image ImageOf(PixelFormat format, const cv::Mat& pixels) {
  Image image;
  image.camera = "rgb";
  image.format = format;
  image.pixels = pixels;
  return image;
}

constexpr int kPatch = 16;

// Flat patches of colours without any symmetry between the channels.
cv::Mat Patches() {
  const cv::Vec3b colours[] = {{10, 90, 230}, {200, 40, 20},  {60, 180, 5},
                               {0, 0, 255},   {250, 120, 33}, {128, 64, 192}};
  cv::Mat bgr(2 * kPatch, 3 * kPatch, CV_8UC3);
  for (int i = 0; i < 6; ++i) {
    bgr(cv::Rect(i % 3 * kPatch, i / 3 * kPatch, kPatch, kPatch)).setTo(colours[i]);
  }
  return bgr;
}

// GenICam's names give the first two pixels of the first row; the second row follows from them.
cv::Mat Mosaic(const cv::Mat& bgr, const std::string& first_row) {
  const std::string second_row = first_row == "RG"   ? "GB"
                                 : first_row == "GR" ? "BG"
                                 : first_row == "GB" ? "RG"
                                                     : "GR";
  const std::string pattern = first_row + second_row;
  cv::Mat mosaic(bgr.size(), CV_8U);
  for (int y = 0; y < bgr.rows; ++y) {
    for (int x = 0; x < bgr.cols; ++x) {
      const char letter = pattern[static_cast<std::size_t>(y % 2 * 2 + x % 2)];
      const int channel = letter == 'B' ? 0 : letter == 'G' ? 1 : 2;
      mosaic.at<std::uint8_t>(y, x) = bgr.at<cv::Vec3b>(y, x)[channel];
    }
  }
  return mosaic;
}

struct Bayer {
  PixelFormat format;
  const char* first_row;
};

class BayerPattern : public testing::TestWithParam<Bayer> {};

TEST_P(BayerPattern, GivesTheColoursBack) {
  const cv::Mat wanted = Patches();
  const Image image = ImageOf(GetParam().format, Mosaic(wanted, GetParam().first_row));
  const cv::Mat bgr = ToBgr(image);
  const cv::Mat grey = ToGrey(image);
  ASSERT_EQ(bgr.type(), CV_8UC3);
  ASSERT_EQ(grey.type(), CV_32FC1);
  for (int y = 0; y < wanted.rows; ++y) {
    for (int x = 0; x < wanted.cols; ++x) {
      // Where a patch meets the next one, or the border, a demosaic has to guess.
      const auto inner = [](int at) { return at % kPatch >= 2 && at % kPatch < kPatch - 2; };
      if (!inner(x) || !inner(y)) continue;
      const auto& colour = wanted.at<cv::Vec3b>(y, x);
      ASSERT_EQ(bgr.at<cv::Vec3b>(y, x), colour) << x << ", " << y;
      const double luma = 0.114 * colour[0] + 0.587 * colour[1] + 0.299 * colour[2];
      ASSERT_NEAR(grey.at<float>(y, x), luma, 0.51);  // rounded to DN
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Patterns, BayerPattern,
    testing::Values(Bayer{PixelFormat::kBayerRg8, "RG"}, Bayer{PixelFormat::kBayerGr8, "GR"},
                    Bayer{PixelFormat::kBayerGb8, "GB"}, Bayer{PixelFormat::kBayerBg8, "BG"}),
    [](const testing::TestParamInfo<Bayer>& info) { return std::string(info.param.first_row); });

TEST(ToGrey, KeepsCounts) {
  const cv::Mat counts = (cv::Mat_<std::uint16_t>(2, 2) << 0, 7000, 16383, 65535);
  const cv::Mat grey = ToGrey(ImageOf(PixelFormat::kMono16, counts));
  ASSERT_EQ(grey.type(), CV_32FC1);
  EXPECT_EQ(grey.at<float>(0, 1), 7000);
  EXPECT_EQ(grey.at<float>(1, 1), 65535);
  const cv::Mat dn = (cv::Mat_<std::uint8_t>(1, 2) << 3, 255);
  EXPECT_EQ(ToGrey(ImageOf(PixelFormat::kMono8, dn)).at<float>(0, 1), 255);
}

TEST(ToBgr, AGreyImageIsGreyInEveryChannel) {
  const cv::Mat dn = (cv::Mat_<std::uint8_t>(1, 2) << 3, 255);
  const cv::Mat bgr = ToBgr(ImageOf(PixelFormat::kMono8, dn));
  EXPECT_EQ(bgr.at<cv::Vec3b>(0, 0), cv::Vec3b(3, 3, 3));
  const cv::Mat picture = Patches();
  EXPECT_EQ(cv::norm(ToBgr(ImageOf(PixelFormat::kBgr8, picture)), picture, cv::NORM_INF), 0);
}

TEST(ToBgr, CompressedPixelsAreAnErrorThatNamesTheCamera) {
  for (const PixelFormat format : {PixelFormat::kJpeg, PixelFormat::kPng}) {
    const Image image = ImageOf(format, cv::Mat(1, 100, CV_8U));
    EXPECT_THAT(InputErrorOf([&] { ToBgr(image); }), HasSubstr("\"rgb\""));
    EXPECT_THAT(InputErrorOf([&] { ToGrey(image); }), HasSubstr("\"rgb\""));
  }
}

// Values 7000 to 7990, as many of each.
cv::Mat Ramp() {
  cv::Mat ramp(100, 100, CV_32F);
  for (int row = 0; row < 100; ++row) ramp.row(row).setTo(7000 + 10 * row);
  return ramp;
}

TEST(Stretch, SpansTheRangeWithoutItsTails) {
  const cv::Mat out = Stretch(Ramp());
  ASSERT_EQ(out.type(), CV_8UC1);
  EXPECT_EQ(out.at<std::uint8_t>(0, 0), 0);
  EXPECT_EQ(out.at<std::uint8_t>(99, 0), 255);
  EXPECT_NEAR(out.at<std::uint8_t>(50, 0), 127.5, 3);  // one of 100 rows is 2.6 DN
}

TEST(Stretch, IsRobustToDeadAndHotPixels) {
  cv::Mat spoiled = Ramp();
  Random random(1);
  for (int i = 0; i < 60; ++i) {  // 0.3% dead and 0.3% hot
    spoiled.at<float>(static_cast<int>(random.Uniform(0, 100)),
                      static_cast<int>(random.Uniform(0, 100))) = i % 2 == 0 ? 0.F : 65535.F;
  }
  const cv::Mat expected = Stretch(Ramp());
  const cv::Mat out = Stretch(spoiled);
  for (int i = 0; i < 10000; ++i) {
    const int y = i / 100;
    const int x = i % 100;
    const float value = spoiled.at<float>(y, x);
    if (value < 1 || value > 60000) continue;
    ASSERT_NEAR(out.at<std::uint8_t>(y, x), expected.at<std::uint8_t>(y, x), 3) << x << ", " << y;
  }
}

TEST(Stretch, AFlatImageDoesNotDivideByZero) {
  const cv::Mat out = Stretch(cv::Mat(20, 20, CV_32F, cv::Scalar(5)));
  EXPECT_EQ(out.at<std::uint8_t>(10, 10), 0);
}

TEST(CheckImage, TheRightSizeAndKindPass) {
  CheckImage(SpecOf(CameraKind::kColor, 4, 3), ImageOf(PixelFormat::kBgr8, cv::Mat(3, 4, CV_8UC3)));
  CheckImage(SpecOf(CameraKind::kColor, 4, 3),
             ImageOf(PixelFormat::kBayerRg8, cv::Mat(3, 4, CV_8UC1)));
  CheckImage(SpecOf(CameraKind::kThermal, 4, 3),
             ImageOf(PixelFormat::kMono16, cv::Mat(3, 4, CV_16UC1)));
}

TEST(CheckImage, AWrongSizeIsNamedWithBothValues) {
  const Image image = ImageOf(PixelFormat::kBgr8, cv::Mat(3, 4, CV_8UC3));
  EXPECT_THAT(InputErrorOf([&] { CheckImage(SpecOf(CameraKind::kColor, 640, 480), image); }),
              AllOf(HasSubstr("\"rgb\""), HasSubstr("4x3"), HasSubstr("640x480")));
}

TEST(CheckImage, AColouredThermalPictureIsRefusedWithWhatToDo) {
  const Image image = ImageOf(PixelFormat::kBgr8, cv::Mat(3, 4, CV_8UC3));
  EXPECT_THAT(InputErrorOf([&] { CheckImage(SpecOf(CameraKind::kThermal, 4, 3), image); }),
              AllOf(HasSubstr("\"thermal\""), HasSubstr("has 3"), HasSubstr("save counts")));
}

TEST(CheckImage, PixelsThatAreNotOfTheirFormatAreRefused) {
  const CameraSpec color = SpecOf(CameraKind::kColor, 4, 3);
  for (const auto& [format, type] :
       std::vector<std::pair<PixelFormat, int>>{{PixelFormat::kBgr8, CV_8UC1},
                                                {PixelFormat::kBayerRg8, CV_8UC3},
                                                {PixelFormat::kMono16, CV_8UC1},
                                                {PixelFormat::kMono8, CV_16UC1},
                                                {PixelFormat::kJpeg, CV_8UC3}}) {
    const Image image = ImageOf(format, cv::Mat(3, 4, type));
    EXPECT_THAT(InputErrorOf([&] { CheckImage(color, image); }), HasSubstr("format"));
  }
}

}  // namespace
}  // namespace rgbdt
