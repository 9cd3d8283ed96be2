#include "calib/present/pictures/lidar_picture.h"

#include <gtest/gtest.h>

namespace rgbdt {
namespace {

CameraReport Found() {
  CameraReport camera;
  camera.calibration.camera = "rgb";
  RangeErrors& errors = camera.calibration.range_errors.emplace();
  errors.offset_m = {0.004, 0.002};
  errors.rings = {{3, {0.012, 0.002}}, {4, {-0.018, 0.003}}, {9, {0.0, 0.003}}};
  errors.intensities = {{-3, {-0.005, 0.001}}, {-2, {0.005, 0.001}}};
  camera.nuisance = {{"beam edge, nothing beyond", "mrad", {1.3, 0.2}},
                     {"beam edge, scatter of single sides", "mrad", {0.4, 0.1}},
                     {"board's thickness", "mm", {20, 3}}};
  return camera;
}

// Rows and columns that the marks cover, of one chart of several below each other.
struct Marks {
  int count = 0;
  double mean_row = 0;
};

Marks MarksIn(const cv::Mat& picture, int chart, int charts, double from, double to) {
  Marks marks;
  const int height = picture.rows / charts;
  for (int y = chart * height; y < (chart + 1) * height; ++y) {
    for (int x = static_cast<int>(from * picture.cols); x < to * picture.cols; ++x) {
      const cv::Vec3b pixel = picture.at<cv::Vec3b>(y, x);
      if (pixel[0] < pixel[2] + 100) continue;  // blue
      ++marks.count;
      marks.mean_row += y - chart * height;
    }
  }
  marks.mean_row /= std::max(1, marks.count);
  return marks;
}

TEST(LidarPicture, HasAChartForEachThatWasFound) {
  CameraReport camera = Found();
  const int three = LidarPicture(camera).rows;
  camera.calibration.range_errors->intensities.clear();
  EXPECT_EQ(LidarPicture(camera).rows, three / 3 * 2);
  camera.calibration.range_errors->rings.clear();
  EXPECT_EQ(LidarPicture(camera).rows, three / 3);
  camera.nuisance.clear();
  EXPECT_TRUE(LidarPicture(camera).empty());
}

TEST(LidarPicture, IsEmptyWhereTheLidarWasTakenForExact) {
  CameraReport camera = Found();
  camera.calibration.range_errors.reset();
  EXPECT_TRUE(LidarPicture(camera).empty());
}

TEST(LidarPicture, PutsWhatIsPositiveAboveWhatIsNegative) {
  const cv::Mat picture = LidarPicture(Found());
  // Three rings side by side, right of the numbers at the axis.
  const Marks first = MarksIn(picture, 0, 3, 0.13, 0.4);
  const Marks second = MarksIn(picture, 0, 3, 0.41, 0.69);
  const Marks third = MarksIn(picture, 0, 3, 0.7, 1);
  ASSERT_GT(first.count, 50);
  ASSERT_GT(second.count, 50);
  ASSERT_GT(third.count, 50);
  EXPECT_LT(first.mean_row, third.mean_row - 20);
  EXPECT_GT(second.mean_row, third.mean_row + 40);
  // The scatter is no edge.
  EXPECT_EQ(MarksIn(picture, 2, 3, 0.13, 0.4).count, 0);
  EXPECT_GT(MarksIn(picture, 2, 3, 0.4, 0.7).count, 50);
}

}  // namespace
}  // namespace rgbdt
