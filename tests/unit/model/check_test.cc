#include "calib/model/check.h"

#include <limits>

#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

constexpr OptionCheck kCheck("kettle");
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();

TEST(OptionCheck, WhatIsGoodPasses) {
  kCheck.Require(true, "litres", kNan, "anything");
  kCheck.Positive(1e-300, "litres");
  kCheck.NotNegative(0, "litres");
  kCheck.AtLeast(2, 2, "spouts");
  kCheck.Between(1, 1, 2, "litres");
  kCheck.Between(2, 1, 2, "litres");
}

TEST(OptionCheck, WhatIsNotIsNamedWithItsOwnerValueAndWhatIsExpected) {
  EXPECT_EQ(InputErrorOf([] { kCheck.Require(false, "litres", 3, "a cup"); }),
            "kettle: litres is 3.000000; expected a cup");
  for (const double bad : {0.0, -1.0, kNan, kInfinite}) {
    EXPECT_NE(InputErrorOf([&] { kCheck.Positive(bad, "litres"); }), "");
  }
  for (const double bad : {-1e-9, kNan, kInfinite}) {
    EXPECT_NE(InputErrorOf([&] { kCheck.NotNegative(bad, "litres"); }), "");
  }
  for (const double bad : {0.999, 2.001, kNan, -kInfinite}) {
    EXPECT_NE(InputErrorOf([&] { kCheck.Between(bad, 1, 2, "litres"); }), "");
  }
  EXPECT_EQ(InputErrorOf([] { kCheck.AtLeast(1, 2, "spouts"); }),
            "kettle: spouts is 1.000000; expected 2 or more");
}

}  // namespace
}  // namespace rgbdt
