#include "calib/present/pictures/map_picture.h"

#include <gtest/gtest.h>

namespace rgbdt {
namespace {

MapCloud Corners() {
  MapCloud map;
  map.voxel_m = 0.1;
  map.points = {{0, 0, 0}, {4, 2, 1}};
  map.rgb = {{10, 20, 30}, {40, 50, 60}};
  return map;
}

TEST(MapPicture, IsSeenFromAboveWithXToTheRight) {
  const cv::Mat picture = MapPicture(Corners(), {}, {}, 41);
  ASSERT_EQ(picture.size(), cv::Size(41, 21));
  EXPECT_EQ(picture.at<cv::Vec3b>(20, 0), cv::Vec3b(30, 20, 10));
  EXPECT_EQ(picture.at<cv::Vec3b>(0, 40), cv::Vec3b(60, 50, 40));
}

// Poses come from anybody: one that lies nowhere near the map is drawn at its edge.
TEST(MapPicture, AWayThatLeavesTheMapEndsAtItsEdge) {
  const cv::Mat picture = MapPicture(Corners(), {{1e300, 1, 0}, {2, 1, 0}}, {{-1e300, 0, 0}}, 41);
  const cv::Vec3b red(40, 40, 255), green(60, 230, 60);
  EXPECT_EQ(picture.at<cv::Vec3b>(10, 40), red);
  EXPECT_EQ(picture.at<cv::Vec3b>(14, 0), green) << "a ring about the lower left corner";
  EXPECT_NE(picture.at<cv::Vec3b>(10, 10), red);
}

}  // namespace
}  // namespace rgbdt
