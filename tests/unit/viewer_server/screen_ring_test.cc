#include "viewer/server/internal/screen_ring.h"

#include <gtest/gtest.h>

namespace rgbdt::viewer {
namespace {

TEST(ScreenRing, NothingWasDrawnYet) { EXPECT_FALSE(ScreenRing().Percentiles()); }

TEST(ScreenRing, PercentilesAreInMilliseconds) {
  ScreenRing ring;
  for (int ms = 100; ms > 0; --ms) ring.Add(ms * 1e-3);
  const auto times = ring.Percentiles();
  ASSERT_TRUE(times);
  EXPECT_NEAR(times->p50, 50, 1e-9);
  EXPECT_NEAR(times->p95, 95, 1e-9);
  EXPECT_EQ(times->count, 100);
}

TEST(ScreenRing, TheNewest200Count) {
  ScreenRing ring;
  for (int i = 0; i < 1000; ++i) ring.Add(5);
  for (int i = 0; i < 200; ++i) ring.Add(0.010);
  const auto times = ring.Percentiles();
  ASSERT_TRUE(times);
  EXPECT_NEAR(times->p95, 10, 1e-9);
  EXPECT_EQ(times->count, 200);
}

}  // namespace
}  // namespace rgbdt::viewer
