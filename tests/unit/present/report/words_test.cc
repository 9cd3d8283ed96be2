#include "calib/present/report/words.h"

#include <gtest/gtest.h>

#include <limits>

namespace rgbdt {
namespace {

TEST(Words, ANumberStaysWithItsUnit) {
  EXPECT_EQ(WithUnit(0.625, 2, "px"), "0.62\u202fpx");
  EXPECT_EQ(WithUnit(0.0333, 3, "°"), "0.033°");
  EXPECT_EQ(WithUnit(-2.8, 1, "mm"), "−2.8\u202fmm");
  EXPECT_EQ(WithUnit(std::optional<double>(), 1, "mm"), "–");
  EXPECT_EQ(WithUnit(std::numeric_limits<double>::quiet_NaN(), 1, "mm"), "–");
  EXPECT_EQ(Number(std::numeric_limits<double>::infinity(), 1), "–");
}

TEST(Words, ATimeOfAClockThatWasNeverSetIsNoDate) {
  EXPECT_EQ(TimeText(1'700'000'000'000'000), "2023-11-14 22:13:20 UTC");
  EXPECT_EQ(TimeText(12'300'000), "12.3 s");
  EXPECT_FALSE(IsDate(12'300'000));
}

TEST(Words, CountsAndLists) {
  EXPECT_EQ(Count(1, "view"), "1 view");
  EXPECT_EQ(Count(0, "view"), "0 views");
  EXPECT_EQ(Joined({"a", "b", "c"}), "a, b, c");
  EXPECT_EQ(Joined({}), "");
}

}  // namespace
}  // namespace rgbdt
