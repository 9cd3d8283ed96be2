#include <gmock/gmock.h>

#include "services/runtime/pacer.h"
#include "services/runtime/periodic.h"

namespace rgbdt {
namespace {

constexpr Utime kMs = 1000;
constexpr Utime kRecorded = 1'500'000'000'000'000;

TEST(Periodic, IsDueAtOnceAndThenOnceAPeriod) {
  Periodic periodic(1000);
  std::vector<Utime> due;
  for (Utime now = 500; now < 4000; now += 300) {
    if (periodic.IsDue(now)) due.push_back(now);
  }
  EXPECT_THAT(due, ::testing::ElementsAre(500, 1700, 2600, 3500)) << "it does not drift";
}

TEST(Periodic, WhatWasMissedIsNotMadeUpFor) {
  Periodic periodic(1000);
  EXPECT_TRUE(periodic.IsDue(0));
  EXPECT_TRUE(periodic.IsDue(7700));
  EXPECT_FALSE(periodic.IsDue(8600));
  EXPECT_TRUE(periodic.IsDue(8700));
}

TEST(Pacer, TheFirstTimeIsNowAndTheOthersFollowAtTheirPace) {
  Pacer pacer;
  EXPECT_EQ(pacer.WaitFor(kRecorded, 77), 0);
  EXPECT_EQ(pacer.WaitFor(kRecorded + 30 * kMs, 77 + 10 * kMs), 20 * kMs);
  EXPECT_EQ(pacer.WaitFor(kRecorded + 30 * kMs, 77 + 30 * kMs), 0);
  EXPECT_EQ(pacer.WaitFor(kRecorded + 60'000 * kMs, 77), 60'000 * kMs);
}

TEST(Pacer, FasterThanRecorded) {
  Pacer pacer(10);
  pacer.WaitFor(kRecorded, 0);
  EXPECT_EQ(pacer.WaitFor(kRecorded + 1000 * kMs, 0), 100 * kMs);
}

TEST(Pacer, ALittleDelayIsCaughtUpWithAndALongOneIsNot) {
  Pacer pacer;
  pacer.WaitFor(kRecorded, 0);
  EXPECT_EQ(pacer.WaitFor(kRecorded + 10 * kMs, 25 * kMs), 0);
  EXPECT_EQ(pacer.WaitFor(kRecorded + 30 * kMs, 25 * kMs), 5 * kMs);
  EXPECT_EQ(pacer.WaitFor(kRecorded + 40 * kMs, 1000 * kMs), 0);
  EXPECT_EQ(pacer.WaitFor(kRecorded + 50 * kMs, 1000 * kMs), 10 * kMs);
}

}  // namespace
}  // namespace rgbdt
