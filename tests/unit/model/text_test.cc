#include "calib/model/text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace rgbdt {
namespace {

TEST(Format, IsPrintfsTextHoweverLong) {
  EXPECT_EQ(Format("%.1f m, %s", 2.25, "left"), "2.2 m, left");
  EXPECT_EQ(Format("%300d", 7).size(), 300U);
  EXPECT_EQ(Format("%s", ""), "");
}

TEST(Fixed, HasSoManyDecimals) {
  EXPECT_EQ(Fixed(1.005, 0), "1");
  EXPECT_EQ(Fixed(-1.25, 3), "-1.250");
  EXPECT_EQ(Fixed(std::numeric_limits<double>::infinity(), 2), "inf");
  EXPECT_EQ(Fixed(std::numeric_limits<double>::max(), 2).size(), 312U);
}

TEST(Exact, ReadsBackAsTheSameBits) {
  EXPECT_EQ(Exact(0.1), "0.1");
  EXPECT_EQ(Exact(-3), "-3");
  std::mt19937_64 random(1);
  for (int i = 0; i < 10000; ++i) {
    const double value = std::ldexp(static_cast<double>(random()) - 9.2e18, i % 600 - 300);
    ASSERT_EQ(std::stod(Exact(value)), value);
  }
}

TEST(ForShell, IsOneWordToAShell) {
  EXPECT_EQ(ForShell("out/session_2.pcd"), "out/session_2.pcd");
  EXPECT_EQ(ForShell("M\xC3\xA4rz"), "M\xC3\xA4rz");
  EXPECT_EQ(ForShell("my session"), "'my session'");
  EXPECT_EQ(ForShell("it's"), "'it'\\''s'");
  EXPECT_EQ(ForShell("$(reboot)"), "'$(reboot)'");
  EXPECT_EQ(ForShell("~/out"), "'~/out'");
  EXPECT_EQ(ForShell(""), "''");
}

TEST(NaturalLess, ComparesDigitsAsNumbers) {
  EXPECT_TRUE(NaturalLess("2", "10"));
  EXPECT_TRUE(NaturalLess("a2b3", "a2b20"));
  EXPECT_TRUE(NaturalLess("01", "1") != NaturalLess("1", "01"));
  EXPECT_FALSE(NaturalLess("7", "7"));
  EXPECT_TRUE(NaturalLess("7", "7a"));
  EXPECT_TRUE(NaturalLess("99999999999999999999998", "99999999999999999999999"));
}

TEST(ValidUtf8, ReplacesOnlyWhatIsNone) {
  const std::string good = "a\u00e9\u20ac\U0001F600";
  EXPECT_EQ(ValidUtf8(good), good);
  EXPECT_EQ(ValidUtf8("a\xff"
                      "b"),
            "a\uFFFDb");
  EXPECT_EQ(ValidUtf8("\xC0\xAF"), "\uFFFD\uFFFD");            // overlong
  EXPECT_EQ(ValidUtf8("\xED\xA0\x80"), "\uFFFD\uFFFD\uFFFD");  // a surrogate
  EXPECT_EQ(ValidUtf8("\xE2\x82"), "\uFFFD\uFFFD");            // cut off
}

}  // namespace
}  // namespace rgbdt
