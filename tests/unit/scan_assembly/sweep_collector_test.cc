#include "calib/scan_assembly/sweep_collector.h"

#include "calib/model/said_again.h"
#include "tests/numbers.h"
#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

using ::testing::HasSubstr;

CloudChunk Chunk(Utime sweep, int first_line, int lines = 1, int beams = 4) {
  CloudChunk chunk;
  chunk.cloud.sweep_utime = sweep;
  chunk.cloud.first_line = first_line;
  chunk.cloud.lines = lines;
  chunk.cloud.beams = beams;
  chunk.cloud.points.assign(static_cast<std::size_t>(lines * beams),
                            Eigen::Vector3f(1, 2, static_cast<float>(first_line)));
  return chunk;
}

CloudChunk End(Utime sweep, int lines) {
  CloudChunk end;
  end.cloud.sweep_utime = sweep;
  end.sweep_end = true;
  end.sweep_lines = lines;
  return end;
}

TEST(SweepCollectorTest, ChunksInAnyOrderAndTwice) {
  SweepCollector sweeps;
  for (const int line : {2, 0, 2, 1}) sweeps.Add(Chunk(kSweep, line));
  EXPECT_FALSE(sweeps.Complete(kSweep).has_value());
  sweeps.Add(End(kSweep, 3));
  const auto cloud = sweeps.Complete(kSweep);
  ASSERT_TRUE(cloud.has_value());
  EXPECT_EQ(cloud->lines, 3);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(cloud->points[static_cast<std::size_t>(4 * i)].z(), static_cast<float>(i));
  }
  EXPECT_FALSE(sweeps.Complete(kSweep + 1).has_value());
}

// Not made whole by what is left of another one's: it ends when all was said.
TEST(SweepCollectorTest, WhatIsSaidAgainTakesThePlaceOfWhatCame) {
  const auto again = [](CloudChunk chunk) {
    chunk.seq = kSaidAgain;
    return chunk;
  };
  SweepCollector sweeps;
  for (int line = 100; line < 300; ++line) sweeps.Add(Chunk(kSweep, line));
  sweeps.Add(End(kSweep, 300));
  ASSERT_NE(sweeps.WhyTorn(kSweep), "");
  for (int line = 0; line < 300; ++line) {
    sweeps.Add(again(Chunk(kSweep, line)));
    ASSERT_FALSE(sweeps.Ended(kSweep)) << line;
  }
  sweeps.Add(Chunk(kSweep, 7));  // one that comes late is no longer of interest
  sweeps.Add(again(End(kSweep, 300)));
  EXPECT_EQ(sweeps.WhyTorn(kSweep), "");
  EXPECT_EQ(sweeps.Complete(kSweep)->lines, 300);
  EXPECT_EQ(sweeps.ChunksOf(kSweep).size(), 301U);
}

// The oldest sweep that is kept after `count` of so many points.
int OldestKept(int count, int points) {
  SweepCollector sweeps;
  for (int i = 0; i < count; ++i) {
    CloudChunk chunk = End(kSweep + i, 1);
    chunk.cloud.lines = 1;
    chunk.cloud.beams = points;
    chunk.cloud.points.assign(static_cast<std::size_t>(points), {1, 2, 3});
    sweeps.Add(chunk);
  }
  for (int i = 0; i < count; ++i) {
    if (sweeps.Ended(kSweep + i)) return i;
  }
  return count;
}

TEST(SweepCollectorTest, KeepsTheNewestOnesBoundedByPointsAndByCount) {
  EXPECT_EQ(OldestKept(5, 3'000'000), 2) << "large ones: kMinSweeps";
  EXPECT_EQ(OldestKept(30, 500'000), 18) << "kKeptPoints";
  EXPECT_EQ(OldestKept(130, 1), 30) << "kMaxSweeps";
}

TEST(SweepCollectorTest, ChunksOfNothingTakeMemoryToo) {
  SweepCollector sweeps;
  for (int i = 0; i < 20; ++i) {
    for (int k = 0; k < 50'000; ++k) {
      CloudChunk nothing = End(kSweep + i, 0);
      nothing.cloud.first_line = k;
      sweeps.Add(nothing);
    }
  }
  EXPECT_FALSE(sweeps.Ended(kSweep + 4));
  EXPECT_TRUE(sweeps.Ended(kSweep + 5)) << "750,000 are kept";
}

TEST(SweepCollectorTest, ChunksThatComeTwiceAreKeptOnce) {
  SweepCollector sweeps;
  for (int i = 0; i < 3; ++i) {
    sweeps.Add(Chunk(kSweep, 0, 0, 0));  // an empty one is no line
    sweeps.Add(Chunk(kSweep, 0));
    sweeps.Add(End(kSweep, 1));
  }
  EXPECT_EQ(sweeps.ChunksOf(kSweep).size(), 3U);
  EXPECT_EQ(sweeps.Complete(kSweep)->lines, 1);
  EXPECT_TRUE(sweeps.ChunksOf(kSweep + 1).empty());
}

// A sweep without an order is as large as what came of it, whatever its end tells.
TEST(SweepCollectorTest, WhatIsTakenCanBeJoined) {
  SweepCollector sweeps;
  CloudChunk stretch = Chunk(kSweep, 0, 1, 1000), far = Chunk(kSweep, 200'000, 1, 2);
  stretch.cloud.organised = far.cloud.organised = false;
  stretch.cloud.origins.assign(1, {0, 0, 1});
  far.cloud.origins = stretch.cloud.origins;
  sweeps.Add(stretch);
  sweeps.Add(far);
  sweeps.Add(End(kSweep, 1'000'000));
  const auto cloud = sweeps.Complete(kSweep);
  ASSERT_TRUE(cloud.has_value());
  EXPECT_EQ(cloud->size(), 1002U);
  EXPECT_EQ(cloud->origins.size(), 1U) << "of its one line";
  EXPECT_THAT(sweeps.WhyTorn(kSweep), HasSubstr("never came"));
}

// What would make the sweep impossible to join, or larger than memory, never gets in.
TEST(SweepCollectorTest, RefusesWhatDoesNotFitTheSweep) {
  SweepCollector sweeps;
  sweeps.Add(Chunk(kSweep, 0));
  EXPECT_THAT(InputErrorOf([&] { sweeps.Add(Chunk(kSweep, 1, 1, 5)); }), HasSubstr("beams"));
  CloudChunk with_rings = Chunk(kSweep, 1);
  with_rings.cloud.ring.assign(4, 0);
  EXPECT_THAT(InputErrorOf([&] { sweeps.Add(with_rings); }), HasSubstr("differ in what they tell"));
  EXPECT_THAT(InputErrorOf([&] { sweeps.Add(Chunk(kSweep, 1'000'000, 1, 4000)); }),
              HasSubstr("more than 8000000 points"));
  EXPECT_THAT(InputErrorOf([&] { sweeps.Add(Chunk(kSweep, 2'000'000, 1, 4)); }),
              HasSubstr("more than 8000000 points"));
  sweeps.Add(Chunk(kSweep, 1));
  sweeps.Add(End(kSweep, 2));
  EXPECT_EQ(sweeps.Complete(kSweep)->lines, 2);
}

// Also where the end comes first.
TEST(SweepCollectorTest, AnEndThatTellsOfMoreThanFitsIsRefused) {
  SweepCollector sweeps;
  sweeps.Add(Chunk(kSweep, 0, 1, 1000));
  EXPECT_THAT(InputErrorOf([&] { sweeps.Add(End(kSweep, 8'001)); }),
              HasSubstr("more than 8000000 points"));
  EXPECT_FALSE(sweeps.Ended(kSweep));
  sweeps.Add(End(kSweep, 8'000));
  EXPECT_EQ(sweeps.Complete(kSweep)->lines, 8'000);
  sweeps.Add(End(kSweep + 1, 8'001));
  EXPECT_THAT(InputErrorOf([&] { sweeps.Add(Chunk(kSweep + 1, 0, 1, 1000)); }),
              HasSubstr("more than 8000000 points"));
}

TEST(SweepCollectorTest, ASweepThatLacksMoreThanOneLineInAHundredIsTorn) {
  struct Case {
    int first, last, lines;
    std::string says;
  };
  const std::vector<Case> cases = {{0, 199, 200, ""},
                                   {2, 199, 200, ""},
                                   {0, 197, 200, ""},
                                   {3, 199, 200, "3 of its 200 lines"},
                                   {0, 196, 200, "3 of its 200 lines"},
                                   {1, 197, 200, "3 of its 200 lines"},
                                   {0, 78, 80, "1 of its 80 lines"},
                                   {0, 0, 0, ""}};
  for (const Case& one : cases) {
    SweepCollector sweeps;
    for (int line = one.first; line <= one.last; ++line) sweeps.Add(Chunk(kSweep, line));
    EXPECT_EQ(sweeps.WhyTorn(kSweep), "") << "it has not ended";
    sweeps.Add(End(kSweep, one.lines));
    EXPECT_EQ(sweeps.WhyTorn(kSweep).empty(), one.says.empty()) << one.first << " " << one.last;
    EXPECT_THAT(sweeps.WhyTorn(kSweep), HasSubstr(one.says));
    EXPECT_EQ(sweeps.Complete(kSweep)->lines, std::max(one.lines, 1));
  }
  SweepCollector nothing_came;
  nothing_came.Add(End(kSweep, 5));
  EXPECT_THAT(nothing_came.WhyTorn(kSweep), HasSubstr("5 of its 5 lines"));
}

}  // namespace
}  // namespace rgbdt
