#include "calib/fuse/seen_through.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rgbdt {
namespace {

// All round at this range, finer than the cells, but for a cone about (1, 0.9, 0.2).
std::vector<Eigen::Vector3f> Shell(float range, bool with_gap) {
  const Eigen::Vector3f gap = Eigen::Vector3f(1, 0.9F, 0.2F).normalized();
  std::vector<Eigen::Vector3f> points;
  for (float azimuth = -3.1416F; azimuth < 3.1416F; azimuth += 0.006F) {
    for (float elevation = -1.57F; elevation < 1.57F; elevation += 0.006F) {
      const Eigen::Vector3f ray(std::cos(elevation) * std::cos(azimuth),
                                std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      if (with_gap && ray.dot(gap) > std::cos(0.1F)) continue;
      points.emplace_back(range * ray);
    }
  }
  return points;
}

TEST(SeenThrough, WhatLiesBeforeWhatIsSeenIsGone) {
  SeenThrough seen(0.01);
  seen.Add(Shell(5, true));
  int gone = 0;
  int count = 0;
  for (const Eigen::Vector3f& p : Shell(3, true)) {
    ++count;
    gone += seen.IsGone(p) ? 1 : 0;
    EXPECT_FALSE(seen.IsGone(1.7F * p)) << "behind";
    EXPECT_FALSE(seen.IsGone(1.62F * p)) << "within the margin";
  }
  EXPECT_GT(gone, 0.9 * count);  // not at the faces' edges
  EXPECT_LT(gone, count);
}

TEST(SeenThrough, WhereNothingWasLookedAtNothingIsGone) {
  SeenThrough seen(0.01);
  const Eigen::Vector3f in_gap = 3 * Eigen::Vector3f(1, 0.9F, 0.2F).normalized();
  EXPECT_FALSE(seen.IsGone(in_gap));
  seen.Add(Shell(5, true));
  EXPECT_FALSE(seen.IsGone(in_gap));
  EXPECT_TRUE(seen.IsGone({-3, 1, 0.3F}));
  seen.Add({{-2, 0.667F, 0.2F}});  // one thing before it is enough
  EXPECT_FALSE(seen.IsGone({-3, 1, 0.3F}));
  seen.Clear();
  EXPECT_FALSE(seen.IsGone({3, 1, 0.3F}));
  EXPECT_FALSE(seen.IsGone({0, 0, 0}));
}

}  // namespace
}  // namespace rgbdt
