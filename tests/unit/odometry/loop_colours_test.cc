#include "calib/odometry/loop_colours.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "calib/model/time.h"

namespace rgbdt {
namespace {

// A wall along x, 3 m high, whose temperature goes up and down along it.
RgbdtCloud Wall(Utime utime, double at_x, double phase = 0, bool warm = true) {
  RgbdtCloud cloud;
  cloud.whole_sweep = true;
  cloud.sweep_utime = cloud.frame_utime = utime;
  cloud.map_from_lidar = Rigid3{Eigen::Quaterniond::Identity(), {at_x, 0, 0}};
  for (double x = -8; x < 8; x += 0.2) {
    for (double z = -1; z < 2; z += 0.2) {
      cloud.points.emplace_back(x, 4, z);
      cloud.rgb.push_back({0, 0, 0});
      const double kelvin = 290 + 3 * z + std::sin(2 * (x + at_x) + phase);
      cloud.temperature_k.push_back(warm ? static_cast<float>(kelvin) : NAN);
    }
  }
  return cloud;
}

LoopColours::Pair Later(double old_from_new_x) {
  LoopColours::Pair pair;
  pair.new_utime = 100 * kMicrosecondsPerSecond;
  pair.old_from_new.translation.x() = old_from_new_x;
  pair.world_from_new.translation.x() = 50;  // as far as odometry drifted
  return pair;
}

// The later place is 0.5 m along the wall, and odometry has it at 50 m.
LoopColours Seen(double phase, bool warm = true) {
  LoopColours colours;
  colours.Add(Wall(0, 0));
  RgbdtCloud later = Wall(100 * kMicrosecondsPerSecond, 0.5, phase, warm);
  later.map_from_lidar->translation.x() = 50;
  colours.Add(later);
  return colours;
}

TEST(LoopColours, OnePlaceIsAlikeWhereTheLoopHasIt) {
  const ColoursAlike alike = Seen(0).Compare(Later(0.5));
  EXPECT_GT(alike.correlation, 0.9);
  EXPECT_GT(alike.cells, 200U);
  EXPECT_EQ(LoopColours::SigmaFactor(alike), 1);
}

TEST(LoopColours, AnotherPlaceIsNot) {
  const ColoursAlike alike = Seen(M_PI / 2).Compare(Later(0.5));
  EXPECT_LT(std::abs(alike.correlation), 0.1)
      << "that walls are warmer above is so everywhere, and does not count";
  EXPECT_GT(LoopColours::SigmaFactor(alike), 50);
  EXPECT_EQ(LoopColours::SigmaFactor(Seen(M_PI).Compare(Later(0.5))), 100);
}

TEST(LoopColours, WhatOneSawAloneTellsNothing) {
  EXPECT_EQ(Seen(0, false).Compare(Later(0.5)).cells, 0U);
  EXPECT_EQ(Seen(0).Compare(Later(40)).cells, 0U);
  EXPECT_EQ(LoopColours().Compare(Later(0.5)).cells, 0U);
  EXPECT_EQ(LoopColours::SigmaFactor({}), 1);
}

TEST(LoopColours, ChunksAndWhatHasNoPlaceAreLeftOut) {
  LoopColours colours;
  RgbdtCloud chunk = Wall(0, 0);
  chunk.whole_sweep = false;
  colours.Add(chunk);
  RgbdtCloud lost = Wall(0, 0);
  lost.map_from_lidar.reset();
  colours.Add(lost);
  EXPECT_EQ(colours.size(), 0U);
}

TEST(LoopColours, MemoryIsBoundedByForgettingEverySecondSweep) {
  LoopColours colours;
  for (int i = 0; i < 3 * static_cast<int>(LoopColours::kMostSweeps); ++i) {
    RgbdtCloud one = Wall(i, 2 * i);
    one.points.resize(1);
    colours.Add(one);
    ASSERT_LT(colours.size(), LoopColours::kMostSweeps);
  }
  EXPECT_GT(colours.size(), LoopColours::kMostSweeps / 2 - 2);
}

}  // namespace
}  // namespace rgbdt
