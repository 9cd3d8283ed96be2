#include "calib/fuse/fuse.h"

#include <cmath>
#include <limits>

#include "tests/unit/fuse/small_camera.h"
#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

using test::SpecOf;
using testing::ElementsAre;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// A picture without any symmetry; every pixel and channel differs from its neighbours.
cv::Mat ColourPicture() {
  cv::Mat bgr(31, 41, CV_8UC3);
  for (int y = 0; y < bgr.rows; ++y) {
    for (int x = 0; x < bgr.cols; ++x) {
      bgr.at<cv::Vec3b>(y, x) = cv::Vec3b(static_cast<std::uint8_t>(x * 37 + y * 11),
                                          static_cast<std::uint8_t>(x * 5 + y * 53 + 90),
                                          static_cast<std::uint8_t>(x * 101 + y * 29 + 7));
    }
  }
  return bgr;
}

cv::Mat CountsPicture() {
  cv::Mat counts(31, 41, CV_32F);
  for (int i = 0; i < 31 * 41; ++i) {
    counts.at<float>(i / 41, i % 41) = static_cast<float>(7000 + i * 7919 % 1000);
  }
  return counts;
}

constexpr Utime kStart = 10'000'000;

FusionCamera Ready(CameraKind kind, const Rigid3& camera_from_lidar = {}) {
  const CameraSpec spec = SpecOf(kind);
  FusionCamera camera(spec);
  const bool thermal = kind == CameraKind::kThermal;
  camera.AddImage({kStart, thermal ? CountsPicture() : ColourPicture(), spec.radiometry});
  camera.calibrated = true;
  camera.camera_from_lidar = camera_from_lidar;
  return camera;
}

Cloud CloudOf(const std::vector<Eigen::Vector3f>& points) {
  Cloud cloud;
  cloud.sweep_utime = kStart;
  cloud.lines = 1;
  cloud.beams = static_cast<int>(points.size());
  cloud.points = points;
  cloud.utime.assign(points.size(), kStart + 5);
  for (std::size_t i = 0; i < points.size(); ++i) {
    cloud.intensity.push_back(0.1F * static_cast<float>(i));
  }
  return cloud;
}

// The point at distance z that a pixel sees.
Eigen::Vector3f Seen(double u, double v, double z) {
  return Eigen::Vector3d((u - 20) / 100 * z, (v - 15) / 100 * z, z).cast<float>();
}

std::array<std::uint8_t, 3> RgbAt(int x, int y) {
  const cv::Vec3b bgr = ColourPicture().at<cv::Vec3b>(y, x);
  return {bgr[2], bgr[1], bgr[0]};
}

TEST(Fuse, APointTakesThePixelsColourAndCounts) {
  const RgbdtCloud fused = Fuse(CloudOf({Seen(7, 22, 4), Seen(20, 15, 2)}),
                                {Ready(CameraKind::kColor), Ready(CameraKind::kThermal)}, 0.01);
  ASSERT_EQ(fused.size(), 2U);
  EXPECT_THAT(fused.cameras, ElementsAre("rgb", "thermal"));
  EXPECT_EQ(fused.sweep_utime, kStart);
  EXPECT_EQ(fused.rgb[0], RgbAt(7, 22));
  EXPECT_EQ(fused.rgb[1], RgbAt(20, 15));
  const float counts = CountsPicture().at<float>(22, 7);
  EXPECT_NEAR(fused.thermal_counts[0], counts, 0.01);  // the float point is 1e-5 px off the pixel
  EXPECT_NEAR(fused.temperature_k[0], 0.04 * counts, 0.001);
  EXPECT_THAT(fused.valid, ElementsAre(3U, 3U));
  EXPECT_THAT(fused.intensity, ElementsAre(0, 0.1F));
  EXPECT_THAT(fused.utime, ElementsAre(kStart + 5, kStart + 5));
}

TEST(Fuse, BetweenPixelsItTakesTheBilinearValue) {
  const RgbdtCloud fused = Fuse(CloudOf({Seen(7.25, 22.75, 1)}),
                                {Ready(CameraKind::kColor), Ready(CameraKind::kThermal)}, 0.01);
  const auto bilinear = [](auto at) {
    return 0.25 * (0.75 * at(7, 22) + 0.25 * at(8, 22)) +
           0.75 * (0.75 * at(7, 23) + 0.25 * at(8, 23));
  };
  for (std::size_t c = 0; c < 3; ++c) {
    const double expected = bilinear([&](int x, int y) { return 1.0 * RgbAt(x, y)[c]; });
    EXPECT_NEAR(fused.rgb[0][c], expected, 0.51);
  }
  const cv::Mat counts = CountsPicture();
  const double expected = bilinear([&](int x, int y) { return 1.0 * counts.at<float>(y, x); });
  EXPECT_NEAR(fused.thermal_counts[0], expected, 0.01);
}

TEST(Fuse, TheImagesBorderPixelsCount) {
  // Powers of two: the border itself is hit exactly.
  CameraSpec spec = SpecOf(CameraKind::kThermal);
  spec.lens = {Lens::Model::kPinhole, 64, 64, 20, 15, {}};
  FusionCamera camera(spec);
  // Cut out of a larger picture of NaN: what reads beyond the border, even with weight 0, shows.
  cv::Mat around(32, 42, CV_32F, cv::Scalar(kNan));
  cv::Mat picture = around(cv::Rect(0, 0, 41, 31));
  CountsPicture().copyTo(picture);
  camera.AddImage({kStart, picture, spec.radiometry});
  camera.calibrated = true;
  const RgbdtCloud fused =
      Fuse(CloudOf({{-20.F / 64, -15.F / 64, 1}, {20.F / 64, 15.F / 64, 1}}), {camera}, 0.01);
  EXPECT_THAT(fused.valid, ElementsAre(1U, 1U));
  EXPECT_EQ(fused.thermal_counts[0], CountsPicture().at<float>(0, 0));
  EXPECT_EQ(fused.thermal_counts[1], CountsPicture().at<float>(30, 40));
}

TEST(Fuse, UsesTheCalibration) {
  // LIDAR axes x forward, y left, z up; the camera 0.5 m to the left of it, looking forward.
  Eigen::Matrix3d axes;
  axes << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  Rigid3 camera_from_lidar;
  camera_from_lidar.rotation = Eigen::Quaterniond(axes);
  camera_from_lidar.translation = -(axes * Eigen::Vector3d(0, 0.5, 0));
  // 5 m ahead, 0.25 m left of the camera and 0.1 m above it: 5 px left and 2 px up.
  const RgbdtCloud fused =
      Fuse(CloudOf({{5, 0.75F, 0.1F}}), {Ready(CameraKind::kColor, camera_from_lidar)}, 0.01);
  EXPECT_EQ(fused.rgb[0], RgbAt(15, 13));
}

TEST(Fuse, NoColourBehindOrOutside) {
  const RgbdtCloud fused =
      Fuse(CloudOf({Seen(7, 22, -4), Seen(-0.1, 15, 3), Seen(40.1, 15, 3), Seen(20, 30.1, 3)}),
           {Ready(CameraKind::kColor), Ready(CameraKind::kThermal)}, 0.01);
  ASSERT_EQ(fused.size(), 4U);  // the points themselves stay
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(fused.valid[i], 0U) << i;
    EXPECT_THAT(fused.rgb[i], ElementsAre(0, 0, 0));
    EXPECT_TRUE(std::isnan(fused.temperature_k[i]));
    EXPECT_TRUE(std::isnan(fused.thermal_counts[i]));
  }
}

TEST(Fuse, NoColourBeyondTheFold) {
  // x (1 - 0.5 x^2) at x = 1.4 is 0.028: the formula would put the point near the image's centre.
  CameraSpec spec = SpecOf(CameraKind::kColor);
  spec.lens.distortion = {-0.5};
  FusionCamera camera(spec);
  camera.AddImage({kStart, ColourPicture(), {}});
  camera.calibrated = true;
  const RgbdtCloud fused = Fuse(CloudOf({{1.4F, 0, 1}, {0.028F, 0, 1}}), {camera}, 0.01);
  EXPECT_THAT(fused.valid, ElementsAre(0U, 1U));
}

TEST(Fuse, MissesAreLeftOut) {
  Cloud cloud = CloudOf({Seen(7, 22, 4), {kNan, kNan, kNan}, Seen(20, 15, 2), {1, kNan, 1}});
  const RgbdtCloud fused = Fuse(cloud, {Ready(CameraKind::kColor)}, 0.01);
  ASSERT_EQ(fused.size(), 2U);
  EXPECT_EQ(fused.points[1], cloud.points[2]);
  EXPECT_EQ(fused.intensity[1], 0.2F);
  EXPECT_EQ(fused.rgb[1], RgbAt(20, 15));
}

TEST(Fuse, WithoutACalibrationNothingIsColoured) {
  FusionCamera camera = Ready(CameraKind::kColor);
  camera.calibrated = false;
  const RgbdtCloud fused = Fuse(CloudOf({Seen(20, 15, 2)}), {camera}, 0.01);
  EXPECT_THAT(fused.valid, ElementsAre(0U));
  EXPECT_THAT(fused.cameras, ElementsAre("rgb"));  // what the bits stand for stays the same
}

TEST(Fuse, EveryPointIsServedByTheImageOfItsOwnTime) {
  FusionCamera camera(SpecOf(CameraKind::kColor));
  camera.calibrated = true;
  camera.AddImage({kStart, cv::Mat(31, 41, CV_8UC3, cv::Scalar(1, 1, 1)), {}});
  camera.AddImage({kStart + 100, cv::Mat(31, 41, CV_8UC3, cv::Scalar(2, 2, 2)), {}});
  Cloud cloud = CloudOf({Seen(20, 15, 2), Seen(20, 15, 2), Seen(20, 15, 2)});
  cloud.utime = {kStart - 1, kStart + 99, kStart + 100};
  const RgbdtCloud fused = Fuse(cloud, {camera}, 0.01);
  EXPECT_THAT(fused.valid, ElementsAre(0U, 1U, 1U));
  EXPECT_EQ(fused.rgb[1][0], 1);
  EXPECT_EQ(fused.rgb[2][0], 2);
}

// A camera with a picture of one value, looking from the side; all see the points squarely alike.
FusionCamera Even(CameraKind kind, double value, const Rigid3& camera_from_lidar = {}) {
  FusionCamera camera(SpecOf(kind));
  const int type = kind == CameraKind::kThermal ? CV_32FC1 : CV_8UC3;
  camera.AddImage(
      {kStart, cv::Mat(31, 41, type, cv::Scalar::all(value)), camera.spec().radiometry});
  camera.calibrated = true;
  camera.camera_from_lidar = camera_from_lidar;
  return camera;
}

Rigid3 Beside(double metres) {
  Rigid3 beside;
  beside.translation = {metres, 0, 0};
  return beside;
}

TEST(Fuse, WhatSeveralCamerasSeeIsBlended) {
  // The second of each kind sees another pixel, and also what the first does not see.
  const Rigid3 beside = Beside(-0.2);  // 10 px to the left at 2 m
  const std::vector<FusionCamera> cameras = {
      Even(CameraKind::kColor, 100), Even(CameraKind::kThermal, 7000),
      Even(CameraKind::kColor, 120, beside), Even(CameraKind::kThermal, 7100, beside)};
  const RgbdtCloud fused =
      Fuse(CloudOf({Seen(25, 15, 2), Seen(45, 15, 2), Seen(3, 15, 2)}), cameras, 0.01);
  EXPECT_THAT(fused.valid, ElementsAre(0b1111U, 0b1100U, 0b0011U));
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_EQ(fused.rgb[0][c], 110);
    EXPECT_EQ(fused.rgb[1][c], 120);
    EXPECT_EQ(fused.rgb[2][c], 100);
  }
  EXPECT_NEAR(fused.temperature_k[0], 0.04 * 7050, 1e-3);
  EXPECT_NEAR(fused.temperature_k[1], 0.04 * 7100, 1e-3);
  EXPECT_THAT(fused.thermal_counts[0], testing::AnyOf(7000, 7100));
}

TEST(Fuse, TheImagesBorderCountsLessAndSaturationNextToNothing) {
  const std::vector<FusionCamera> at_border = {Even(CameraKind::kColor, 100),
                                               Even(CameraKind::kColor, 200, Beside(-0.2))};
  // At 39.5 of 40 px of the first image, in the middle of the second.
  const RgbdtCloud border = Fuse(CloudOf({Seen(39.5, 15, 2)}), at_border, 0.01);
  EXPECT_GT(border.rgb[0][0], 175);
  EXPECT_LT(border.rgb[0][0], 199);
  const std::vector<FusionCamera> saturated = {Even(CameraKind::kColor, 100),
                                               Even(CameraKind::kColor, 255, Beside(-0.1))};
  EXPECT_NEAR(Fuse(CloudOf({Seen(22, 15, 2)}), saturated, 0.01).rgb[0][0], 103, 1);
  // But where nobody else sees the point, saturated is what it is.
  EXPECT_EQ(Fuse(CloudOf({Seen(43, 15, 2)}), saturated, 0.01).rgb[0][0], 255);
}

// A board 1 m wide at 2 m, and one behind it whose middle it hides; a camera to the left sees more
// of the left.
TEST(Fuse, WhatIsBehindSomethingElseIsNotColoured) {
  Cloud cloud;
  cloud.sweep_utime = kStart;
  cloud.lines = 25;
  cloud.beams = 35;
  std::vector<bool> hidden;
  const double aside = 0.3;
  for (int line = 0; line < cloud.lines; ++line) {
    for (int beam = 0; beam < cloud.beams; ++beam) {
      const bool near = beam >= 12 && beam < 23;
      const double z = near ? 2 : 4;
      cloud.points.push_back(Seen(3 + beam, 3 + line, z));
      // Where the line of sight from the camera, `aside` to the left, meets the near board's plane.
      const double x = cloud.points.back().x();
      const double at_near = 0.5 * (x - aside);
      hidden.push_back(!near && at_near > -0.01 * 5.5 * 2 && at_near < 0.01 * 5.5 * 2);
    }
  }
  FusionCamera camera = Ready(CameraKind::kColor, Beside(aside));
  const RgbdtCloud fused = Fuse(cloud, {camera}, 0.01);
  int wrong = 0;
  int seen = 0;
  int behind = 0;
  for (std::size_t i = 0; i < fused.size(); ++i) {
    const Eigen::Vector3f p = fused.points[i];
    const double u = 20 + 100 * (p.x() + aside) / p.z();
    if (u < 0 || u > 40) continue;
    behind += hidden[i] ? 1 : 0;
    seen += hidden[i] ? 0 : 1;
    wrong += (fused.valid[i] != 0) == hidden[i] ? 1 : 0;
  }
  EXPECT_GT(behind, 50);
  EXPECT_GT(seen, 400);
  EXPECT_LE(wrong, 3 * cloud.lines);  // within a beam of the edge nobody knows
}

TEST(Fuse, ACloudThatTellsNoTimesIsAsOldAsItsSweep) {
  Cloud cloud = CloudOf({Seen(20, 15, 2)});
  cloud.utime.clear();
  cloud.intensity.clear();
  const RgbdtCloud fused = Fuse(cloud, {Ready(CameraKind::kColor)}, 0.01);
  EXPECT_THAT(fused.utime, ElementsAre(kStart));
  EXPECT_TRUE(std::isnan(fused.intensity[0]));
  EXPECT_THAT(fused.valid, ElementsAre(1U));
}

}  // namespace
}  // namespace rgbdt
