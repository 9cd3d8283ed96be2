#include "calib/scan_assembly/sweep_chunks.h"

#include <gtest/gtest.h>

#include "calib/scan_assembly/assembler.h"

namespace rgbdt {
namespace {

Cloud Made(int lines, int beams, bool organised) {
  Cloud cloud;
  cloud.sweep_utime = 5;
  cloud.lines = lines;
  cloud.beams = beams;
  cloud.organised = organised;
  const int size = lines * beams;
  for (int i = 0; i < size; ++i) {
    cloud.points.emplace_back(static_cast<float>(i), 1.0F, 2.0F);
    cloud.directions.emplace_back(0.0F, 0.0F, 1.0F);
    cloud.utime.push_back(1000 + i);
    cloud.ring.push_back(static_cast<std::uint16_t>(i / beams));
  }
  return cloud;
}

TEST(SplitSweep, NoChunkIsLargeAndTogetherTheyAreTheSweep) {
  for (const auto& [lines, beams] : {std::pair(128, 2000), std::pair(1, 1), std::pair(16, 1800)}) {
    const Cloud sweep = Made(lines, beams, true);
    const auto chunks = SplitSweep(sweep);
    for (const CloudChunk& chunk : chunks) {
      EXPECT_LE(chunk.cloud.size() * 38, 1024u * 1024u);
      EXPECT_EQ(chunk.sweep_end, &chunk == &chunks.back());
    }
    EXPECT_EQ(chunks.back().sweep_lines, lines);
    const Cloud joined = JoinChunks(chunks);
    EXPECT_EQ(joined.lines, lines);
    EXPECT_EQ(joined.points, sweep.points);
    EXPECT_EQ(joined.directions, sweep.directions);
    EXPECT_EQ(joined.utime, sweep.utime);
    EXPECT_EQ(joined.ring, sweep.ring);
  }
}

TEST(SplitSweep, ACloudWithoutOrderIsCutToo) {
  const Cloud sweep = Made(1, 200'001, false);
  const auto chunks = SplitSweep(sweep);
  EXPECT_GT(chunks.size(), 1u);
  for (const CloudChunk& chunk : chunks) {
    EXPECT_EQ(chunk.cloud.lines, 1);
    EXPECT_EQ(chunk.cloud.beams, chunks[0].cloud.beams);
    EXPECT_LE(chunk.cloud.size() * 38, 1024u * 1024u);
  }
  const Cloud joined = JoinChunks(chunks);
  ASSERT_GE(joined.size(), sweep.size());
  EXPECT_LT(joined.size(), sweep.size() + chunks.size());
  for (std::size_t i = 0; i < joined.size(); ++i) {
    ASSERT_EQ(joined.IsHit(i), i < sweep.size());
    if (i < sweep.size()) {
      ASSERT_EQ(joined.points[i], sweep.points[i]);
    }
  }
}

TEST(SplitSweep, AnEmptySweepStillEnds) {
  Cloud sweep;
  sweep.sweep_utime = 9;
  const auto chunks = SplitSweep(sweep);
  ASSERT_EQ(chunks.size(), 1u);
  EXPECT_TRUE(chunks[0].sweep_end);
  EXPECT_EQ(chunks[0].cloud.sweep_utime, 9);
}

}  // namespace
}  // namespace rgbdt
