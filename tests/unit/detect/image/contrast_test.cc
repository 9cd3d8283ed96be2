#include "calib/detect/image/contrast.h"

#include <opencv2/core.hpp>

#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

constexpr int kSide = 20;  // [px]

Target SmallTarget() {
  Target target;
  target.squares_x = 7;
  target.squares_y = 5;
  target.square_m = 0.1;
  return target;
}

// Squares that differ by `step`, on a slope as of a board that is warmer at one end.
cv::Mat Board(float step, float slope) {
  cv::Mat grey(5 * kSide, 7 * kSide, CV_32F);
  for (int y = 0; y < grey.rows; ++y) {
    for (int x = 0; x < grey.cols; ++x) {
      const bool black = (x / kSide + y / kSide) % 2 == 0;
      grey.at<float>(y, x) = 7000.F + (black ? step : 0.F) + slope * static_cast<float>(x);
    }
  }
  return grey;
}

std::vector<Eigen::Vector2d> BoardCorners() {
  std::vector<Eigen::Vector2d> corners;
  for (int row = 1; row < 5; ++row) {
    for (int column = 1; column < 7; ++column) {
      corners.emplace_back(column * kSide - 0.5, row * kSide - 0.5);
    }
  }
  return corners;
}

TEST(SquareContrast, IsTheStepBetweenSquaresWhateverItsSign) {
  EXPECT_NEAR(SquareContrast(Board(15, 0), SmallTarget(), BoardCorners()), 15, 1e-3);
  EXPECT_NEAR(SquareContrast(Board(-15, 0), SmallTarget(), BoardCorners()), 15, 1e-3);
  EXPECT_NEAR(SquareContrast(Board(0, 0), SmallTarget(), BoardCorners()), 0, 1e-3);
}

// From square to square the slope makes 40 counts, more than the squares' own 15.
TEST(SquareContrast, ASlopeOverTheBoardDoesNotCount) {
  EXPECT_NEAR(SquareContrast(Board(15, 2), SmallTarget(), BoardCorners()), 15, 2);
}

TEST(SquareContrast, AHandOverAFewSquaresDoesNotCount) {
  cv::Mat grey = Board(15, 0);
  grey(cv::Rect(40, 20, 30, 30)).setTo(9000);
  EXPECT_NEAR(SquareContrast(grey, SmallTarget(), BoardCorners()), 15, 1e-3);
}

TEST(SquareContrast, SquaresOutsideTheImageAreNone) {
  std::vector<Eigen::Vector2d> corners = BoardCorners();
  for (Eigen::Vector2d& corner : corners) corner.x() += 1000;
  EXPECT_EQ(SquareContrast(Board(15, 0), SmallTarget(), corners), 0);
}

// Of a board of which a column lies outside the image.
TEST(SquareContrast, CornersThatAreNotSeenDoNotCount) {
  std::vector<Eigen::Vector2d> corners = BoardCorners();
  const double all = SquareContrast(Board(50, 0), SmallTarget(), corners);
  for (std::size_t i = 0; i < corners.size(); i += 6) corners[i].setConstant(std::nan(""));
  EXPECT_NEAR(SquareContrast(Board(50, 0), SmallTarget(), corners), all, 1e-6);
}

}  // namespace
}  // namespace rgbdt
