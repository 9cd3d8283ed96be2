#include "calib/model/time.h"

#include <gtest/gtest.h>

namespace rgbdt {
namespace {

TEST(Time, SecondsRoundToTheNearestMicrosecond) {
  EXPECT_EQ(FromSeconds(0), 0);
  EXPECT_EQ(FromSeconds(1.5), 1'500'000);
  EXPECT_EQ(FromSeconds(-1.5), -1'500'000);
  EXPECT_EQ(FromSeconds(0.1), 100'000);  // 0.1 is not a binary fraction
  EXPECT_EQ(FromSeconds(1.6e-6), 2);
  EXPECT_EQ(FromSeconds(-1.6e-6), -2);
  EXPECT_EQ(FromSeconds(1.4e-6), 1);
}

TEST(Time, SecondsAndMicrosecondsAreInverse) {
  for (const Utime utime : {Utime{0}, Utime{1}, Utime{-7}, Utime{123'456'789}}) {
    EXPECT_EQ(FromSeconds(ToSeconds(utime)), utime);
  }
}

}  // namespace
}  // namespace rgbdt
