#include "calib/methods/natural/image_rims.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rgbdt {
namespace {

// Dark left of x = 40.3, bright right of it, a blur of a pixel between; no edge elsewhere.
cv::Mat Step() {
  cv::Mat image(80, 100, CV_32FC1);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      image.at<float>(y, x) = static_cast<float>(50 + 100 * 0.5 * std::erfc((40.3 - x) / 1.4));
    }
  }
  // What is usual elsewhere: a slow rise, so that a step stands out.
  for (int y = 0; y < image.rows; ++y) image.row(y) += 0.3 * y;
  return image;
}

TEST(ImageRims, MeetsAnEdgeWhereItIs) {
  const ImageRims rims(Step(), 0);
  std::vector<ImageRim> met;
  rims.Meet({43, 30}, {1, 0}, 6, &met);
  ASSERT_EQ(met.size(), 1U);
  EXPECT_NEAR(met[0].offset, -2.7, 0.1);
  EXPECT_NEAR(std::abs(met[0].normal.x()), 1, 1e-3);
  // Aslant: the same edge, farther along the line.
  rims.Meet({43, 30}, Eigen::Vector2d(1, 0.5).normalized(), 8, &met);
  ASSERT_EQ(met.size(), 1U);
  EXPECT_NEAR(met[0].offset * Eigen::Vector2d(1, 0.5).normalized().x(), -2.7, 0.15);
}

TEST(ImageRims, CoarserPicturesHaveItAtTheSamePlace) {
  const ImageRims rims(Step(), 2);
  std::vector<ImageRim> met;
  const Eigen::Vector2d at = rims.ToLevel({44, 32});
  rims.Meet(at, {1, 0}, 5, &met);
  ASSERT_EQ(met.size(), 1U);
  EXPECT_NEAR(rims.pixels() * met[0].offset, -3.7, 0.6);
}

TEST(ImageRims, MeetsNothingWhereNothingIs) {
  const ImageRims rims(Step(), 0);
  std::vector<ImageRim> met;
  rims.Meet({70, 30}, {1, 0}, 6, &met);
  EXPECT_TRUE(met.empty());
  rims.Meet({400, 30}, {1, 0}, 6, &met);  // beyond the image
  EXPECT_TRUE(met.empty());
  const ImageRims even(cv::Mat(50, 50, CV_32FC1, cv::Scalar(7)), 0);
  even.Meet({25, 25}, {1, 0}, 6, &met);
  EXPECT_TRUE(met.empty());
}

}  // namespace
}  // namespace rgbdt
