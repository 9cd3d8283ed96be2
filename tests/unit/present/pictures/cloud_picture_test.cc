#include "calib/present/pictures/cloud_picture.h"

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
  options.notes = false;
  return options;
}

// What a cloud without points looks like.
cv::Mat Ground(const DrawOptions& options = Small()) {
  return DrawCloud(RgbdtCloud{}, CloudColour::kRgb, options);
}

// Pixels that differ from the ground.
int Drawn(const cv::Mat& picture, const cv::Mat& ground) {
  cv::Mat difference, grey;
  cv::absdiff(picture, ground, difference);
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
    EXPECT_GT(Drawn(picture, Ground()), 400 * 250 / 4);
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
    cloud.temperature_sigma_k.push_back(test::kNan);
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
  const cv::Vec3b& centre = picture.at<cv::Vec3b>(125, 200);
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
  EXPECT_GT(Drawn(picture(cv::Rect(0, 0, 200, 125)), Ground()(cv::Rect(0, 0, 200, 125))), 0);
  EXPECT_EQ(Drawn(picture(cv::Rect(200, 0, 200, 250)), Ground()(cv::Rect(200, 0, 200, 250))), 0);
  EXPECT_EQ(Drawn(picture(cv::Rect(0, 125, 400, 125)), Ground()(cv::Rect(0, 125, 400, 125))), 0);
}

TEST(CloudPicture, PointsThatNoCameraSawAreGreyByIntensity) {
  RgbdtCloud cloud = test::MakeRgbdtCloud(1, 1);
  cloud.points[0] = {3, 0, 0};
  cloud.rgb[0] = {0, 0, 0};
  DrawOptions options = Small();
  options.eye = Eigen::Vector3d(0, 0, 0);
  options.look_at = Eigen::Vector3d(3, 0, 0);
  options.point_size = 20;
  const auto centre = [&](float intensity) {
    cloud.intensity[0] = intensity;
    return DrawCloud(cloud, CloudColour::kRgb, options).at<cv::Vec3b>(125, 200);
  };
  const cv::Vec3b dim = centre(0), bright = centre(1);
  EXPECT_TRUE(dim[0] == dim[1] && dim[1] == dim[2]);
  EXPECT_TRUE(bright[0] == bright[1] && bright[1] == bright[2]);
  EXPECT_GT(bright[0], dim[0] + 30);
  EXPECT_LT(bright[0], 150);
}

// All but one in a hundred are at 20 degrees C: one at 500 does not take the scale.
TEST(CloudPicture, AnOutlierDoesNotTakeTheScaleOfTemperatures) {
  RgbdtCloud cloud = test::MakeRgbdtCloud(300, 200);
  const cv::Mat before = DrawCloud(cloud, CloudColour::kThermal, Small());
  for (std::size_t i = 0; i < cloud.size(); i += 300) {
    float& kelvin = cloud.temperature_k[i + 150];
    if (std::isfinite(kelvin)) kelvin = 773;
  }
  const cv::Mat after = DrawCloud(cloud, CloudColour::kThermal, Small());
  EXPECT_LT(Drawn(after, before), 400 * 250 / 10);
}

TEST(CloudPicture, TheCaptionAndTheAxesCanBeLeftOut) {
  DrawOptions with = Small();
  with.notes = true;
  with.title = "view 0001";
  const cv::Mat written = Ground(with), bare = Ground();
  EXPECT_GT(Drawn(written(cv::Rect(0, 0, 400, 50)), bare(cv::Rect(0, 0, 400, 50))), 100);
  EXPECT_GT(Drawn(written(cv::Rect(0, 130, 130, 120)), bare(cv::Rect(0, 130, 130, 120))), 50);
  EXPECT_EQ(Drawn(bare, Ground()), 0);
}

TEST(CloudPicture, SideBySideIsBothOfOneViewpoint) {
  const RgbdtCloud cloud = test::MakeRgbdtCloud();
  const cv::Mat both = DrawSideBySide(cloud, Small());
  ASSERT_EQ(both.size(), cv::Size(808, 250));
  const auto same = [&](int left, CloudColour colour) {
    const cv::Mat alone = DrawCloud(cloud, colour, Small());
    return Drawn(both(cv::Rect(left, 0, 400, 250)), alone) == 0;
  };
  EXPECT_TRUE(same(0, CloudColour::kRgb));
  EXPECT_TRUE(same(408, CloudColour::kThermal));
  // The outline does not depend on the colour.
  const auto outline = [](const cv::Mat& picture) {
    cv::Mat difference, grey;
    cv::absdiff(picture, Ground(), difference);
    cv::cvtColor(difference, grey, cv::COLOR_BGR2GRAY);
    return cv::Mat(grey(cv::Rect(0, 0, 280, 250)) > 3);  // beside the legend
  };
  EXPECT_LT(cv::countNonZero(outline(DrawCloud(cloud, CloudColour::kRgb, Small())) !=
                             outline(DrawCloud(cloud, CloudColour::kThermal, Small()))),
            280 * 250 / 100);
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
