#include "calib/detect/image/internal/corner_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>

#include "calib/camera/pixels.h"
#include "tests/unit/detect/image/painted_board.h"

namespace rgbdt {
namespace {

std::vector<Eigen::Vector2d> Reversed(const std::vector<Eigen::Vector2d>& corners) {
  return {corners.rbegin(), corners.rend()};
}

std::vector<Eigen::Vector2d> Mirrored(std::vector<Eigen::Vector2d> corners, int columns) {
  for (auto row = corners.begin(); row != corners.end(); row += columns) {
    std::reverse(row, row + columns);
  }
  return corners;
}

TEST(CornerOrder, BlackTellsTopFromBottomInAnyLight) {
  PaintedBoard board;
  board.noise = 2;
  cv::Mat grey = ToGrey(board.Paint());
  // From left to right eight times as bright: white on the left is darker than black on the right.
  for (int y = 0; y < grey.rows; ++y) {
    for (int x = 0; x < grey.cols; ++x) {
      grey.at<float>(y, x) *= 1 + 7 * static_cast<float>(x) / static_cast<float>(grey.cols);
    }
  }
  EXPECT_EQ(TopLeftIsDark(grey, board.target, board.Corners()), true);
  EXPECT_EQ(TopLeftIsDark(grey, board.target, Reversed(board.Corners())), false);

  auto corners = Reversed(board.Corners());
  EXPECT_TRUE(OrderCorners(grey, board.target, true, &corners));
  EXPECT_EQ(corners, board.Corners());
  EXPECT_TRUE(OrderCorners(grey, board.target, true, &corners));
  EXPECT_EQ(corners, board.Corners());
}

TEST(CornerOrder, InAThermalImageNothingIsGuessed) {
  PaintedBoard board;
  std::swap(board.black, board.white);  // black is the warmer one here
  const cv::Mat grey = ToGrey(board.Paint());
  auto corners = board.Corners();
  EXPECT_FALSE(OrderCorners(grey, board.target, false, &corners));
  EXPECT_EQ(corners, board.Corners());
  corners = Reversed(corners);
  EXPECT_FALSE(OrderCorners(grey, board.target, false, &corners));
  EXPECT_EQ(corners, Reversed(board.Corners()));
}

TEST(CornerOrder, APatternThatIsItsOwnHalfTurnTellsNothing) {
  PaintedBoard board;
  board.target.squares_x = 10;
  const cv::Mat grey = ToGrey(board.Paint());
  EXPECT_EQ(TopLeftIsDark(grey, board.target, board.Corners()), true);
  EXPECT_EQ(TopLeftIsDark(grey, board.target, Reversed(board.Corners())), true);
  auto corners = board.Corners();
  EXPECT_FALSE(OrderCorners(grey, board.target, true, &corners));
}

TEST(CornerOrder, AMirroredOrderIsPutRight) {
  PaintedBoard board;
  const cv::Mat grey = ToGrey(board.Paint());
  auto corners = Mirrored(board.Corners(), board.target.corners_x());
  EXPECT_FALSE(RightHanded(board.target, corners));
  EXPECT_TRUE(OrderCorners(grey, board.target, true, &corners));
  EXPECT_TRUE(RightHanded(board.target, corners));
  EXPECT_EQ(corners, board.Corners());
}

TEST(CornerOrder, SquaresThatDoNotAlternateTellNothing) {
  const PaintedBoard board;
  cv::Mat grey(board.height, board.width, CV_32F);
  cv::RNG random(1);
  random.fill(grey, cv::RNG::NORMAL, 100, 20);
  EXPECT_FALSE(TopLeftIsDark(grey, board.target, board.Corners()).has_value());
  grey.setTo(80);
  EXPECT_FALSE(TopLeftIsDark(grey, board.target, board.Corners()).has_value());
}

}  // namespace
}  // namespace rgbdt
