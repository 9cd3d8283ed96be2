#include "services/bus/sequence.h"

#include <gtest/gtest.h>

#include <vector>

namespace rgbdt {
namespace {

using Kind = SequenceCounter::Kind;

std::int64_t Missing(const std::vector<std::int64_t>& numbers) {
  SequenceCounter counter;
  std::int64_t missing = 0;
  for (const std::int64_t seq : numbers) missing += counter.Add(seq).gaps;
  return missing;
}

Kind LastKind(const std::vector<std::int64_t>& numbers) {
  SequenceCounter counter;
  Kind kind = Kind::kFirst;
  for (const std::int64_t seq : numbers) kind = counter.Add(seq).kind;
  return kind;
}

TEST(Sequence, BeginsAnywhere) {
  EXPECT_EQ(LastKind({700}), Kind::kFirst);
  EXPECT_EQ(LastKind({700, 701}), Kind::kNext);
  EXPECT_EQ(Missing({700, 701, 702}), 0);
}

TEST(Sequence, CountsWhatIsMissing) {
  EXPECT_EQ(LastKind({0, 1, 5}), Kind::kGap);
  EXPECT_EQ(Missing({0, 1, 5}), 3);
  EXPECT_EQ(Missing({0, 1, 5, 6, 8}), 4);
  EXPECT_EQ(Missing({0, 1000}), 999);
}

TEST(Sequence, LateOnesAreNotMissing) {
  EXPECT_EQ(LastKind({0, 2, 1}), Kind::kLate);
  EXPECT_EQ(Missing({0, 2, 1, 3}), 0);
  EXPECT_EQ(Missing({1, 2, 9, 5, 7, 10}), 4);
  EXPECT_EQ(Missing({0, 64, 1}), 62);
}

TEST(Sequence, DuplicatesChangeNothing) {
  EXPECT_EQ(LastKind({4, 4}), Kind::kDuplicate);
  EXPECT_EQ(LastKind({4, 5, 6, 5}), Kind::kDuplicate);
  EXPECT_EQ(LastKind({0, 0}), Kind::kDuplicate);
  EXPECT_EQ(LastKind({0, 2, 1, 1}), Kind::kDuplicate);
  EXPECT_EQ(Missing({4, 5, 6, 5, 6, 7}), 0);
}

TEST(Sequence, RestartsAtZeroAreNoGap) {
  EXPECT_EQ(LastKind({5, 6, 0}), Kind::kRestart);
  EXPECT_EQ(Missing({5, 6, 0, 1, 2}), 0);
  EXPECT_EQ(Missing({100'000, 0, 1, 3}), 1);
}

TEST(Sequence, RestartWhoseFirstOnesWereLost) {
  EXPECT_EQ(LastKind({1000, 3}), Kind::kRestart);
  EXPECT_EQ(Missing({1000, 3, 4}), 3);
  EXPECT_EQ(Missing({1000, 3, 1, 0, 2}), 0);
}

TEST(Sequence, AnotherCountFarAwayIsNoGap) {
  EXPECT_EQ(LastKind({5'000'000, 70'000}), Kind::kRestart);
  EXPECT_EQ(Missing({5'000'000, 70'000, 70'001}), 0);
  EXPECT_EQ(Missing({5, std::int64_t{1} << 53, 6, 7}), 6);
}

}  // namespace
}  // namespace rgbdt
