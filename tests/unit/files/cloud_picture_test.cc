#include "calib/files/cloud_picture.h"

#include <opencv2/imgproc.hpp>

#include "calib/files/image_files.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using ::testing::HasSubstr;

DrawOptions Small() {
  DrawOptions options;
  options.width = 400;
  options.height = 250;
  return options;
}

// Pixels that differ from the ground.
int Drawn(const cv::Mat& picture, int ground) {
  cv::Mat difference, grey;
  cv::absdiff(picture, cv::Scalar::all(ground), difference);
  cv::cvtColor(difference, grey, cv::COLOR_BGR2GRAY);
  return cv::countNonZero(grey > 3);
}

TEST(CloudPicture, FillsAGoodPartOfThePicture) {
  const RgbdtCloud cloud = test::MakeRgbdtCloud(300, 200);
  for (const CloudColour colour :
       {CloudColour::kRgb, CloudColour::kThermal, CloudColour::kIntensity}) {
    const cv::Mat picture = DrawCloud(cloud, colour, Small());
    EXPECT_EQ(picture.type(), CV_8UC3);
    EXPECT_EQ(picture.size(), cv::Size(400, 250));
    EXPECT_GT(Drawn(picture, 24), 400 * 250 / 4);
  }
}

TEST(CloudPicture, IsTheSameEveryTime) {
  const RgbdtCloud cloud = test::MakeRgbdtCloud();
  const cv::Mat first = DrawCloud(cloud, CloudColour::kThermal, Small());
  const cv::Mat second = DrawCloud(cloud, CloudColour::kThermal, Small());
  EXPECT_EQ(cv::norm(first, second, cv::NORM_INF), 0);
}

TEST(CloudPicture, TheNearerPointHidesTheOther) {
  RgbdtCloud cloud = test::MakeRgbdtCloud(1, 1);
  const auto add = [&](double x, std::array<std::uint8_t, 3> rgb) {
    cloud.points.emplace_back(x, 0, 0);
    cloud.rgb.push_back(rgb);
    cloud.intensity.push_back(0.5f);
    cloud.utime.push_back(0);
    cloud.temperature_k.push_back(test::kNan);
    cloud.thermal_counts.push_back(test::kNan);
    cloud.valid.push_back(1);
  };
  add(2, {255, 0, 0});
  add(4, {0, 255, 0});
  DrawOptions options = Small();
  options.eye = Eigen::Vector3d(-1, 0, 0);
  options.look_at = Eigen::Vector3d(2, 0, 0);
  options.point_size = 20;
  const cv::Mat picture = DrawCloud(cloud, CloudColour::kRgb, options);
  const cv::Vec3b centre = picture.at<cv::Vec3b>(125, 200);
  EXPECT_GT(centre[2], 200);
  EXPECT_LT(centre[1], 50);
}

TEST(CloudPicture, LeftIsLeftAndUpIsUp) {
  RgbdtCloud cloud = test::MakeRgbdtCloud(1, 1);
  cloud.points[0] = {3, 0.5, 0.5};  // left of and above the line of sight
  cloud.rgb[0] = {255, 255, 255};
  DrawOptions options = Small();
  options.eye = Eigen::Vector3d(0, 0, 0);
  options.look_at = Eigen::Vector3d(3, 0, 0);
  options.point_size = 10;
  const cv::Mat picture = DrawCloud(cloud, CloudColour::kRgb, options);
  EXPECT_GT(Drawn(picture(cv::Rect(0, 0, 200, 125)), 24), 0);
  EXPECT_EQ(Drawn(picture(cv::Rect(200, 0, 200, 250)), 24), 0);
  EXPECT_EQ(Drawn(picture(cv::Rect(0, 125, 400, 125)), 24), 0);
}

TEST(CloudPicture, OddCloudsAreDrawnToo) {
  EXPECT_EQ(DrawCloud(RgbdtCloud{}, CloudColour::kThermal, Small()).size(), cv::Size(400, 250));
  RgbdtCloud cloud = test::MakeRgbdtCloud(3, 3);
  for (auto& point : cloud.points) point.setConstant(test::kNan);
  EXPECT_NO_THROW(DrawCloud(cloud, CloudColour::kRgb, Small()));
  for (auto& point : cloud.points) point.setZero();
  EXPECT_NO_THROW(DrawCloud(cloud, CloudColour::kIntensity, Small()));
  cloud.points[0] = {1e30f, -1e30f, 1e30f};
  for (float& t : cloud.temperature_k) t = 300;
  EXPECT_NO_THROW(DrawCloud(cloud, CloudColour::kThermal, Small()));
}

TEST(CloudPicture, BadOptionsAndCloudsAreErrors) {
  DrawOptions options = Small();
  options.width = 0;
  EXPECT_THAT(test::ErrorOf([&] { DrawCloud(RgbdtCloud{}, CloudColour::kRgb, options); }),
              HasSubstr("width is 0"));
  RgbdtCloud cloud = test::MakeRgbdtCloud(3, 3);
  cloud.rgb.pop_back();
  test::ErrorOf([&] { DrawCloud(cloud, CloudColour::kRgb, Small()); });
}

}  // namespace
}  // namespace rgbdt
