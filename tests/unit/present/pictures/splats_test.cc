#include "calib/present/pictures/internal/splats.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace rgbdt {
namespace {

const cv::Vec3b kRed(0, 0, 200), kGreen(0, 200, 0), kGround(20, 20, 20);

Canvas Empty(int size) {
  return {cv::Mat(size, size, CV_8UC3, cv::Scalar(20, 20, 20)),
          cv::Mat(size, size, CV_32FC1, cv::Scalar(kNoDepth))};
}

void Paint(const cv::Rect& area, const cv::Vec3b& bgr, float depth, Canvas* canvas) {
  canvas->bgr(area).setTo(cv::Scalar(bgr[0], bgr[1], bgr[2]));
  canvas->depth(area).setTo(cv::Scalar(depth));
}

// Every pixel of `area` is of that colour.
bool IsAll(const Canvas& canvas, const cv::Rect& area, const cv::Vec3b& bgr) {
  cv::Mat same;
  const cv::Scalar colour(bgr[0], bgr[1], bgr[2]);
  cv::inRange(canvas.bgr(area), colour, colour, same);
  return cv::countNonZero(same) == area.area();
}

// A surface with gaps like a grid's lines, through which another one shows, or nothing.
TEST(Splats, HolesInASurfaceAreClosed) {
  for (const bool behind : {false, true}) {
    Canvas canvas = Empty(60);
    if (behind) Paint({0, 0, 60, 60}, kGreen, 6, &canvas);
    for (int y = 10; y < 50; y += 5) {
      for (int x = 10; x < 50; x += 5) Paint({x, y, 3, 3}, kRed, 4, &canvas);
    }
    CloseHoles(&canvas);
    EXPECT_TRUE(IsAll(canvas, {15, 15, 28, 28}, kRed)) << behind;
    EXPECT_EQ(canvas.depth.at<float>(28, 28), 4);
  }
}

TEST(Splats, OutlinesStayWhereTheyAre) {
  Canvas canvas = Empty(60);
  Paint({0, 0, 30, 60}, kRed, 4, &canvas);
  Paint({0, 40, 60, 20}, kRed, 4, &canvas);  // an inner corner with it
  CloseHoles(&canvas);
  EXPECT_TRUE(IsAll(canvas, {30, 0, 30, 40}, kGround));
  EXPECT_TRUE(IsAll(canvas, {0, 0, 30, 60}, kRed));
}

// A window with something in it, or an empty one, stays a window.
TEST(Splats, WideHolesStayOpen) {
  Canvas canvas = Empty(60);
  Paint({0, 0, 60, 60}, kRed, 4, &canvas);
  Paint({20, 20, 20, 20}, kGround, kNoDepth, &canvas);
  CloseHoles(&canvas);
  EXPECT_TRUE(IsAll(canvas, {24, 24, 12, 12}, kGround));
}

// Between a near surface and a far one there is nothing to fill in.
TEST(Splats, AGapBetweenTwoSurfacesStaysOpen) {
  Canvas canvas = Empty(60);
  Paint({0, 0, 29, 60}, kRed, 4, &canvas);
  Paint({31, 0, 29, 60}, kGreen, 6, &canvas);
  CloseHoles(&canvas);
  EXPECT_TRUE(IsAll(canvas, {29, 0, 2, 60}, kGround));
}

TEST(Splats, TheNearestDiscIsInFrontWhateverTheOrder) {
  for (const bool near_first : {false, true}) {
    Canvas canvas = Empty(30);
    const Splat near_one{{15, 15}, 5, 4, kRed}, far_one{{15, 15}, 9, 6, kGreen};
    DrawSplats(
        near_first ? std::vector<Splat>{near_one, far_one} : std::vector<Splat>{far_one, near_one},
        &canvas);
    EXPECT_EQ(canvas.bgr.at<cv::Vec3b>(15, 15), kRed);
    EXPECT_EQ(canvas.bgr.at<cv::Vec3b>(15, 22), kGreen);
    EXPECT_EQ(canvas.bgr.at<cv::Vec3b>(2, 2), kGround);
  }
}

TEST(Splats, AStepInDepthIsDarkened) {
  Canvas canvas = Empty(60);
  Paint({0, 0, 30, 60}, kRed, 4, &canvas);
  Paint({30, 0, 30, 60}, kRed, 6, &canvas);
  Shade(&canvas);
  EXPECT_LT(canvas.bgr.at<cv::Vec3b>(30, 31)[2], 190);
  EXPECT_EQ(canvas.bgr.at<cv::Vec3b>(30, 28), kRed);
  EXPECT_EQ(canvas.bgr.at<cv::Vec3b>(30, 50), kRed);
}

}  // namespace
}  // namespace rgbdt
