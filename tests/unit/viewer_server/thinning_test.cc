#include "viewer/server/internal/thinning.h"

#include <gtest/gtest.h>

namespace rgbdt::viewer {
namespace {

constexpr std::size_t kRecords = 6400;

// A cloud is sent while `waiting` others wait.
std::size_t Sent(Thinning* thinning, std::size_t waiting = 0) {
  return thinning->Cut("chunk", kRecords, waiting);
}

TEST(Thinning, AllIsSentWhileNothingIsDropped) {
  Thinning thinning;
  for (int i = 0; i < 100; ++i) EXPECT_EQ(Sent(&thinning), kRecords);
  EXPECT_EQ(thinning.share(), 1);
}

TEST(Thinning, DropsHalveTheShareOnceTheHalfWasTried) {
  Thinning thinning;
  thinning.Dropped();
  thinning.Dropped();
  EXPECT_EQ(thinning.share(), 0.5);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(Sent(&thinning, 8), kRecords / 2);
  thinning.Dropped();
  EXPECT_EQ(thinning.share(), 0.25);
}

TEST(Thinning, ShareEndsAtOneOf64) {
  Thinning thinning;
  for (int i = 0; i < 100; ++i) {
    thinning.Dropped();
    for (int sent = 0; sent < 4; ++sent) Sent(&thinning, 8);
  }
  EXPECT_EQ(thinning.share(), 1.0 / 64);
  EXPECT_EQ(Sent(&thinning, 8), kRecords / 64);
}

TEST(Thinning, ShareGrowsBackWhereTheQueueStaysShort) {
  Thinning thinning;
  thinning.Dropped();
  for (int i = 0; i < 19; ++i) EXPECT_EQ(Sent(&thinning), kRecords / 2);
  EXPECT_EQ(Sent(&thinning), kRecords * 3 / 4);
  for (int i = 0; i < 40; ++i) Sent(&thinning);
  EXPECT_EQ(thinning.share(), 1);
}

TEST(Thinning, ShareDoesNotGrowWhileCloudsWait) {
  Thinning thinning;
  thinning.Dropped();
  for (int i = 0; i < 100; ++i) EXPECT_EQ(Sent(&thinning, 2), kRecords / 2);
}

TEST(Thinning, SweepIsCutToThePointsWanted) {
  Thinning thinning;
  thinning.WantPoints(10'000);
  const auto sweep = [&] {
    std::size_t sent = 0;
    for (const char* topic : {"sweep/0", "sweep/1", "sweep/2", "sweep/3"}) {
      sent += thinning.Cut(topic, 10'000, 0);
    }
    return sent;
  };
  sweep();  // how long a sweep is, is known behind the first
  EXPECT_EQ(sweep(), 10'000U);
  EXPECT_EQ(sweep(), 10'000U);
  EXPECT_EQ(thinning.share(), 0.25);
  EXPECT_EQ(thinning.Cut("chunk", 1000, 0), 250U);
  thinning.WantPoints(20'000);
  EXPECT_EQ(sweep(), 20'000U);
}

TEST(Thinning, SweepsWhosePartsAreMissingAreNotTakenForOneLongOne) {
  Thinning thinning;
  thinning.WantPoints(20'000);
  for (const char* topic : {"sweep/0", "sweep/1", "sweep/1", "sweep/1", "sweep/0", "sweep/1"}) {
    EXPECT_EQ(thinning.Cut(topic, 10'000, 0), 10'000U);
  }
}

TEST(Thinning, OneRecordIsAlwaysSent) {
  Thinning thinning;
  thinning.WantPoints(1);
  thinning.Cut("sweep/0", 1'000'000, 0);
  EXPECT_EQ(thinning.Cut("sweep/1", 100, 0), 1U);
  EXPECT_EQ(thinning.Cut("sweep/2", 0, 0), 0U);
}

}  // namespace
}  // namespace rgbdt::viewer
