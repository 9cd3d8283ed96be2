#include "services/nodes/step_timeout.h"

#include <gtest/gtest.h>

#include <limits>

namespace rgbdt {
namespace {

constexpr double kTimeout = 10;

class StepTimeoutTest : public ::testing::Test {
 protected:
  void SetUp() override { timeout_.Begin(At(0), kTimeout); }
  static Utime At(double seconds) { return FromSeconds(seconds); }
  bool IsOver(double seconds) { return !timeout_.WhyOver(At(seconds)).empty(); }

  StepTimeout timeout_;
};

TEST_F(StepTimeoutTest, SilenceEndsAStep) {
  EXPECT_FALSE(IsOver(kTimeout));
  EXPECT_TRUE(IsOver(kTimeout + 1));
}

TEST_F(StepTimeoutTest, EachSendersProgressCountsByItself) {
  timeout_.OnProgress("motor", 0.5);
  EXPECT_FALSE(IsOver(9));
  timeout_.OnProgress("lidar", 0.2);
  EXPECT_FALSE(IsOver(18));
  timeout_.OnProgress("motor", 0.5);
  timeout_.OnProgress("lidar", 0.1);
  EXPECT_TRUE(IsOver(29)) << "neither got on";
}

TEST_F(StepTimeoutTest, WhatIsNoFractionIsNoProgress) {
  for (const double fraction : {std::numeric_limits<double>::quiet_NaN(),
                                std::numeric_limits<double>::infinity(), -0.1, 1.1}) {
    timeout_.OnProgress("motor", fraction);
  }
  EXPECT_EQ(timeout_.WhyOver(At(11)), "no answer in 10 s");
}

// The process was held up, and its progress waited meanwhile.
TEST_F(StepTimeoutTest, ProgressThatWaitedIsAsGoodAsNew) {
  timeout_.OnProgress("motor", 0.5);
  EXPECT_FALSE(IsOver(30));
  EXPECT_FALSE(IsOver(39));
  EXPECT_TRUE(IsOver(41));
}

TEST_F(StepTimeoutTest, AskedAgainProgressCountsFromNoughtAndTheWholeIsBounded) {
  timeout_.OnProgress("motor", 0.9);
  EXPECT_FALSE(IsOver(9));
  timeout_.AskedAgain(At(9));
  EXPECT_EQ(timeout_.began(), At(9));
  timeout_.OnProgress("motor", 0.1);
  EXPECT_FALSE(IsOver(20));
  timeout_.AskedAgain(At(kTimeout * StepTimeout::kMostTimes));
  EXPECT_FALSE(IsOver(kTimeout * StepTimeout::kMostTimes));
  EXPECT_TRUE(IsOver(kTimeout * StepTimeout::kMostTimes + 1));
}

TEST_F(StepTimeoutTest, ManySendersAreNoEndOfMemoryOrTime) {
  for (std::size_t i = 0; i < StepTimeout::kMostSenders; ++i) {
    timeout_.OnProgress(std::to_string(i), 0.5);
  }
  EXPECT_FALSE(IsOver(5));
  timeout_.OnProgress("one more", 0.5);
  EXPECT_TRUE(IsOver(16));
}

}  // namespace
}  // namespace rgbdt
