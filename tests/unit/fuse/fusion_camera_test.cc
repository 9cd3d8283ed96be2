#include "calib/fuse/fusion_camera.h"

#include "tests/unit/fuse/small_camera.h"
#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

using test::SpecOf;
using testing::HasSubstr;

PreparedImage At(Utime utime) { return {utime, cv::Mat(31, 41, CV_8UC3, cv::Scalar(1, 2, 3)), {}}; }

Utime ServedBy(const FusionCamera& camera, Utime point) {
  const PreparedImage* image = camera.ServingAt(point).image;
  return image == nullptr ? -1 : image->utime;
}

class ServingTest : public testing::Test {
 protected:
  static constexpr Utime kReadout = 30'000;

  ServingTest() : camera_(WithReadout()) {}
  static CameraSpec WithReadout() {
    CameraSpec spec = SpecOf(CameraKind::kColor);
    spec.readout_s = 0.03;
    return spec;
  }
  FusionCamera camera_;
};

TEST_F(ServingTest, AnImageServesFromItsTimePlusReadoutUntilTheNextOnes) {
  camera_.AddImage(At(1'000'000));
  camera_.AddImage(At(1'500'000));
  EXPECT_EQ(ServedBy(camera_, 1'000'000 + kReadout - 1), -1);
  EXPECT_EQ(ServedBy(camera_, 1'000'000 + kReadout), 1'000'000);
  EXPECT_EQ(ServedBy(camera_, 1'500'000), 1'000'000);  // taken, but not yet read out
  EXPECT_EQ(ServedBy(camera_, 1'500'000 + kReadout - 1), 1'000'000);
  EXPECT_EQ(ServedBy(camera_, 1'500'000 + kReadout), 1'500'000);
}

TEST_F(ServingTest, ThinnedImagesServeAllOfTheTime) {
  constexpr Utime kSpan = 12'000'000;
  for (Utime utime = 0; utime <= kSpan; utime += 50'000) {
    camera_.AddImage(At(utime), FusionCamera::Full::kThin);
  }
  EXPECT_EQ(ServedBy(camera_, kReadout), 0);
  EXPECT_EQ(ServedBy(camera_, kSpan + kReadout), kSpan);
  for (Utime utime = 0; utime <= kSpan; utime += 50'000) {
    EXPECT_LE(utime - ServedBy(camera_, utime + kReadout), 2 * kSpan / 15) << utime;
  }
  camera_.ForgetBefore(kSpan);
  EXPECT_EQ(ServedBy(camera_, kReadout), -1);
  for (Utime utime = kSpan; utime <= 2 * kSpan; utime += 50'000) camera_.AddImage(At(utime));
  EXPECT_EQ(ServedBy(camera_, 2 * kSpan - 700'000 + kReadout), 2 * kSpan - 700'000)
      << "without thinning the last 16 stay";
}

TEST_F(ServingTest, ATimeOffsetMovesWhatAnImageServes) {
  camera_.AddImage(At(1'000'000));
  CameraCalibration calibration;
  calibration.timing = CameraTiming{{0.2, 1e-4}, {-0.015, 1e-5}};
  camera_.SetCalibration(calibration, 1);
  EXPECT_EQ(ServedBy(camera_, 1'200'000 + kReadout - 1), -1);
  EXPECT_EQ(ServedBy(camera_, 1'200'000 + kReadout), 1'000'000);
  EXPECT_EQ(camera_.TakenAt(*camera_.ServingAt(1'300'000).image), 1'200'000);
  EXPECT_EQ(camera_.spec().rolling_s, -0.015);
  EXPECT_TRUE(camera_.Has(calibration, 1));
  calibration.timing.reset();
  EXPECT_FALSE(camera_.Has(calibration, 1));
  camera_.SetCalibration(calibration, 1);
  EXPECT_EQ(ServedBy(camera_, 1'000'000 + kReadout), 1'000'000);
  EXPECT_EQ(camera_.spec().rolling_s, 0);
}

TEST_F(ServingTest, AnImageWhoseTimeIsLateServesNothingBeforeItIsThere) {
  camera_.AddImage(At(1'000'000));
  camera_.AddImage(At(1'500'000));
  CameraCalibration calibration;
  calibration.timing = CameraTiming{{-0.2, 1e-4}, {0, 1e-5}};
  camera_.SetCalibration(calibration, 1);
  EXPECT_EQ(ServedBy(camera_, 1'500'000 + kReadout - 1), 1'000'000);
  EXPECT_EQ(ServedBy(camera_, 1'500'000 + kReadout), 1'500'000);
  EXPECT_EQ(camera_.TakenAt(*camera_.ServingAt(1'600'000).image), 1'300'000);
  camera_.ForgetBefore(1'500'000 + kReadout - 1);
  EXPECT_EQ(ServedBy(camera_, 1'500'000), 1'000'000);
}

TEST_F(ServingTest, AnImageServesNoLongerThanItsMaximumAge) {
  camera_.AddImage(At(1'000'000));
  EXPECT_EQ(ServedBy(camera_, 1'000'000 + FusionCamera::kMaxAge), 1'000'000);
  EXPECT_EQ(ServedBy(camera_, 1'000'000 + FusionCamera::kMaxAge + 1), -1);
}

TEST_F(ServingTest, AnOlderImageDoesNotStandInForOneThatIsTooOld) {
  camera_.AddImage(At(1'000'000));
  camera_.AddImage(At(1'500'000));
  EXPECT_EQ(ServedBy(camera_, 1'500'000 + FusionCamera::kMaxAge + 1), -1);
}

TEST_F(ServingTest, TheOrderInWhichImagesComeDoesNotMatter) {
  for (const Utime utime : {3, 1, 4, 2, 5}) camera_.AddImage(At(utime * 100'000));
  for (const Utime utime : {1, 2, 3, 4, 5}) {
    EXPECT_EQ(ServedBy(camera_, utime * 100'000 + kReadout), utime * 100'000);
  }
}

TEST_F(ServingTest, TheSameImageTwiceIsOne) {
  camera_.AddImage(At(1'000'000));
  PreparedImage again = At(1'000'000);
  again.pixels.setTo(cv::Scalar(9, 9, 9));
  camera_.AddImage(again);
  EXPECT_EQ(camera_.ServingAt(1'100'000).image->pixels.at<cv::Vec3b>(0, 0), cv::Vec3b(1, 2, 3));
  // It takes no place either: all of kMaxImages are still there.
  for (Utime n = 1; n < static_cast<Utime>(FusionCamera::kMaxImages); ++n) {
    camera_.AddImage(At(1'000'000 + n * 1000));
    camera_.AddImage(At(1'000'000 + n * 1000));
  }
  EXPECT_EQ(ServedBy(camera_, 1'000'000 + kReadout), 1'000'000);
}

TEST_F(ServingTest, TheOldestOfTooManyGoes) {
  for (Utime n = 0; n <= static_cast<Utime>(FusionCamera::kMaxImages); ++n) {
    camera_.AddImage(At(1'000'000 + n * 1000));
  }
  EXPECT_EQ(ServedBy(camera_, 1'000'000 + kReadout), -1);
  EXPECT_EQ(ServedBy(camera_, 1'001'000 + kReadout), 1'001'000);
}

TEST_F(ServingTest, ForgettingKeepsTheImageThatServesFromThenOn) {
  camera_.AddImage(At(1'000'000));
  camera_.AddImage(At(1'500'000));
  camera_.AddImage(At(2'000'000));
  camera_.ForgetBefore(1'500'000 + kReadout - 1);
  EXPECT_EQ(ServedBy(camera_, 1'500'000 + kReadout - 1), 1'000'000);
  camera_.ForgetBefore(1'500'000 + kReadout);
  EXPECT_EQ(ServedBy(camera_, 1'500'000 + kReadout - 1), -1);
  EXPECT_EQ(ServedBy(camera_, 1'500'000 + kReadout), 1'500'000);
  camera_.ForgetBefore(9'000'000);  // the newest stays
  EXPECT_EQ(ServedBy(camera_, 2'100'000), 2'000'000);
}

TEST_F(ServingTest, ServingAllTimesTakesTheNewestImage) {
  camera_.ServeAllTimes();
  EXPECT_EQ(ServedBy(camera_, 5), -1);
  camera_.AddImage(At(1'500'000));
  camera_.AddImage(At(1'000'000));
  EXPECT_EQ(ServedBy(camera_, 5), 1'500'000);
  EXPECT_EQ(ServedBy(camera_, 900'000'000), 1'500'000);
}

TEST(Prepare, AMosaicBecomesColourAndCountsStayCounts) {
  Image image;
  image.camera = "rgb";
  image.utime = 7;
  image.format = PixelFormat::kBayerRg8;
  image.pixels = cv::Mat(31, 41, CV_8UC1, cv::Scalar(50));
  const PreparedImage colour = Prepare(SpecOf(CameraKind::kColor), image);
  EXPECT_EQ(colour.utime, 7);
  EXPECT_EQ(colour.pixels.type(), CV_8UC3);
  image.format = PixelFormat::kMono16;
  image.pixels = cv::Mat(31, 41, CV_16UC1, cv::Scalar(7000));
  const PreparedImage thermal = Prepare(SpecOf(CameraKind::kThermal), image);
  EXPECT_EQ(thermal.pixels.type(), CV_32FC1);
  EXPECT_EQ(thermal.pixels.at<float>(3, 4), 7000);
}

TEST(Prepare, AnImagesOwnRadiometryGoesBeforeTheRigs) {
  Image image;
  image.camera = "thermal";
  image.format = PixelFormat::kMono16;
  image.pixels = cv::Mat(31, 41, CV_16UC1, cv::Scalar(7000));
  EXPECT_EQ(Prepare(SpecOf(CameraKind::kThermal), image).radiometry.gain, 0.04);
  image.radiometry.kind = Radiometry::Kind::kLinear;
  image.radiometry.gain = 0.4;
  EXPECT_EQ(Prepare(SpecOf(CameraKind::kThermal), image).radiometry.gain, 0.4);
}

TEST(Prepare, AnImageOfAnotherSizeIsRefused) {
  Image image;
  image.camera = "rgb";
  image.format = PixelFormat::kBgr8;
  image.pixels = cv::Mat(31, 40, CV_8UC3);
  EXPECT_THAT(InputErrorOf([&] { Prepare(SpecOf(CameraKind::kColor), image); }),
              HasSubstr("40x31"));
}

}  // namespace
}  // namespace rgbdt
