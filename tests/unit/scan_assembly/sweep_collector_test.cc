#include "calib/scan_assembly/sweep_collector.h"

#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

using ::testing::HasSubstr;

constexpr Utime kSweep = 1'500'000'000'000'000;

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

}  // namespace
}  // namespace rgbdt
