#include "calib/model/cloud.h"

#include <limits>

#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

const Eigen::Vector3f kUnknown = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());

// Two lines of two beams from origins of their own; the last beam of each returned nothing.
Cloud TwoLines() {
  Cloud cloud;
  cloud.lines = 2;
  cloud.beams = 2;
  cloud.origins = {{0, 0, 1}, {0, 0, 2}};
  cloud.points = {{3, 0, 1}, kUnknown, {0, 4, 2}, kUnknown};
  cloud.directions = {kUnknown, {0, 0, 1}, kUnknown, kUnknown};
  return cloud;
}

TEST(DirectionOf, OfAHitFollowsFromItsPointAndItsLinesOrigin) {
  const Cloud cloud = TwoLines();
  EXPECT_EQ(DirectionOf(cloud, 0), Eigen::Vector3f(1, 0, 0));
  EXPECT_EQ(DirectionOf(cloud, 1), Eigen::Vector3f(0, 0, 1));
  EXPECT_EQ(DirectionOf(cloud, 2), Eigen::Vector3f(0, 1, 0));
  EXPECT_FALSE(DirectionOf(cloud, 3).allFinite());
}

TEST(DirectionOf, WhatTheSensorSaysHolds) {
  Cloud cloud = TwoLines();
  cloud.directions[0] = Eigen::Vector3f(0.6F, 0.8F, 0);
  EXPECT_EQ(DirectionOf(cloud, 0), Eigen::Vector3f(0.6F, 0.8F, 0));
}

TEST(LostLines, AreThoseOfWhichNothingIsKnown) {
  Cloud cloud = TwoLines();
  EXPECT_EQ(LostLines(cloud), 0);
  cloud.points[2] = kUnknown;
  EXPECT_EQ(LostLines(cloud), 1);
  cloud.directions[3] = Eigen::Vector3f(0, 0, 1);
  EXPECT_EQ(LostLines(cloud), 0);
  cloud.directions.clear();
  EXPECT_EQ(LostLines(cloud), 0) << "a sensor that tells of no misses";
}

}  // namespace
}  // namespace rgbdt
