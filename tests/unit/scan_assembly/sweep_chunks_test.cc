#include "calib/scan_assembly/sweep_chunks.h"

#include <cmath>

#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

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

// As a file holds it that was cut out of a larger sweep.
TEST(SplitSweep, ASweepLacksNoLinesBeforeItsFirst) {
  Cloud cut = Made(4, 3, true);
  cut.first_line = 7;
  EXPECT_EQ(MissingLines(SplitSweep(cut)), 0);
  EXPECT_EQ(JoinChunks(SplitSweep(cut)).points, cut.points);
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

// A chunk of `lines` lines whose points' x is their line in the sweep.
CloudChunk ChunkOf(int first_line, int lines, int beams) {
  CloudChunk chunk;
  chunk.cloud.sweep_utime = 77;
  chunk.cloud.first_line = first_line;
  chunk.cloud.lines = lines;
  chunk.cloud.beams = beams;
  for (int line = first_line; line < first_line + lines; ++line) {
    chunk.cloud.origins.emplace_back(0.F, 0.F, static_cast<float>(line));
    for (int beam = 0; beam < beams; ++beam) {
      const auto x = static_cast<float>(line);
      const auto y = static_cast<float>(beam);
      chunk.cloud.points.emplace_back(x, y, 0.F);
      chunk.cloud.directions.emplace_back(x, y, 1.F);
      chunk.cloud.intensity.push_back(x);
      chunk.cloud.utime.push_back(1000 * line + beam);
      chunk.cloud.ring.push_back(static_cast<std::uint16_t>(beam));
    }
  }
  return chunk;
}

std::vector<int> LinesOf(const Cloud& cloud) {
  std::vector<int> lines;
  for (int line = 0; line < cloud.lines; ++line) {
    lines.push_back(
        static_cast<int>(cloud.points[static_cast<std::size_t>(line * cloud.beams)].x()));
  }
  return lines;
}

TEST(JoinChunks, PutsLinesInOrderWhateverOrderTheyComeIn) {
  const std::vector<CloudChunk> in_order = {ChunkOf(0, 2, 3), ChunkOf(2, 1, 3), ChunkOf(3, 2, 3)};
  const std::vector<CloudChunk> shuffled = {in_order[2], in_order[0], in_order[1]};
  for (const auto& chunks : {in_order, shuffled}) {
    const Cloud sweep = JoinChunks(chunks);
    EXPECT_EQ(sweep.sweep_utime, 77);
    EXPECT_EQ(sweep.first_line, 0);
    EXPECT_EQ(sweep.beams, 3);
    EXPECT_THAT(LinesOf(sweep), ElementsAre(0, 1, 2, 3, 4));
    ASSERT_EQ(sweep.size(), 15U);
    ASSERT_EQ(sweep.origins.size(), 5U);
    for (std::size_t i = 0; i < sweep.size(); ++i) {  // every vector in step with the points
      const float line = sweep.points[i].x();
      const float beam = sweep.points[i].y();
      EXPECT_EQ(sweep.directions[i], Eigen::Vector3f(line, beam, 1));
      EXPECT_EQ(sweep.intensity[i], line);
      EXPECT_EQ(sweep.utime[i], static_cast<Utime>(1000 * line + beam));
      EXPECT_EQ(sweep.ring[i], static_cast<std::uint16_t>(beam));
      EXPECT_EQ(sweep.origins[i / 3].z(), line);
    }
  }
}

TEST(JoinChunks, MissingLinesKeepTheirPlaceAndAreKnownToBeLost) {
  const Cloud sweep = JoinChunks({ChunkOf(3, 2, 3), ChunkOf(0, 2, 3)});
  EXPECT_EQ(sweep.lines, 5);
  ASSERT_EQ(sweep.points.size(), 15U);
  for (std::size_t i = 0; i < 15; ++i) {
    EXPECT_EQ(std::isnan(sweep.points[i].x()), i / 3 == 2) << i;
  }
  EXPECT_EQ(LostLines(sweep), 1);
  EXPECT_EQ(LostLines(JoinChunks({ChunkOf(0, 2, 3), ChunkOf(2, 3, 3)})), 0);
  // Every vector stays in step with the points, so the lines behind the gap keep what is theirs.
  ASSERT_EQ(sweep.directions.size(), 15U);
  ASSERT_EQ(sweep.intensity.size(), 15U);
  ASSERT_EQ(sweep.utime.size(), 15U);
  ASSERT_EQ(sweep.ring.size(), 15U);
  ASSERT_EQ(sweep.origins.size(), 5U);
  for (std::size_t i = 9; i < 15; ++i) {
    const std::size_t line = i / 3;
    EXPECT_EQ(sweep.points[i].x(), static_cast<float>(line));
    EXPECT_EQ(sweep.intensity[i], static_cast<float>(line));
    EXPECT_EQ(sweep.utime[i], static_cast<Utime>(1000 * line + i % 3));
    EXPECT_EQ(sweep.origins[line].z(), static_cast<float>(line));
  }
  for (std::size_t i = 0; i < 15; ++i) EXPECT_EQ(sweep.ring[i], i % 3);
}

// As where a process was started in the midst of the sweep, or the last chunk before the end is
// lost.
TEST(JoinChunks, LinesMissingAtHeadAndTailAreThereAndKnownToBeLost) {
  CloudChunk end;
  end.sweep_end = true;
  end.sweep_lines = 6;
  const std::vector<CloudChunk> chunks = {ChunkOf(2, 2, 3), end};
  const Cloud sweep = JoinChunks(chunks);
  EXPECT_EQ(sweep.first_line, 0);
  EXPECT_EQ(sweep.lines, 6);
  EXPECT_EQ(LostLines(sweep), 4);
  EXPECT_EQ(MissingLines(chunks), 4);
  ASSERT_EQ(sweep.points.size(), 18U);
  ASSERT_EQ(sweep.directions.size(), 18U);
  ASSERT_EQ(sweep.intensity.size(), 18U);
  ASSERT_EQ(sweep.ring.size(), 18U);
  ASSERT_EQ(sweep.utime.size(), 18U);
  ASSERT_EQ(sweep.origins.size(), 6U);
  for (std::size_t i = 0; i < 18; ++i) {
    const std::size_t line = i / 3;
    EXPECT_EQ(sweep.IsHit(i), line == 2 || line == 3) << i;
    EXPECT_EQ(sweep.ring[i], i % 3);
    if (sweep.IsHit(i)) {
      EXPECT_EQ(sweep.points[i].x(), static_cast<float>(line));
      EXPECT_EQ(sweep.utime[i], static_cast<Utime>(1000 * line + i % 3));
    }
  }
  EXPECT_EQ(sweep.utime.front(), 2000) << "the nearest that is known";
  EXPECT_EQ(sweep.utime.back(), 3002);
}

TEST(MissingLines, CountsWhatNeverCameOfAnySweep) {
  EXPECT_EQ(MissingLines({}), 0);
  EXPECT_EQ(MissingLines({ChunkOf(0, 2, 3), ChunkOf(2, 3, 3)}), 0);
  EXPECT_EQ(MissingLines({ChunkOf(4, 2, 3), ChunkOf(1, 2, 3), ChunkOf(4, 2, 3)}), 2);
  std::vector<CloudChunk> stretches = SplitSweep(Made(1, 200'001, false));
  EXPECT_EQ(MissingLines(stretches), 0);
  ASSERT_GT(stretches.size(), 2U);
  stretches.erase(stretches.begin());
  EXPECT_EQ(MissingLines(stretches), 1);
  EXPECT_FALSE(JoinChunks(stretches).organised);
}

TEST(JoinChunks, AnEndThatTellsOfMorePointsThanAllowedIsAnError) {
  CloudChunk end;
  end.sweep_lines = 1'000'000;
  EXPECT_THAT(InputErrorOf([&] {
                JoinChunks({ChunkOf(0, 1, 101), end});
              }),
              HasSubstr("reaches to line 1000000 of 101 beams"));
}

TEST(JoinChunks, AChunkThatCameTwiceCountsOnce) {
  const Cloud sweep = JoinChunks({ChunkOf(0, 2, 3), ChunkOf(2, 1, 3), ChunkOf(0, 2, 3)});
  EXPECT_THAT(LinesOf(sweep), ElementsAre(0, 1, 2));
}

TEST(JoinChunks, AnUnorganisedSweepIsOneLine) {
  CloudChunk first = ChunkOf(0, 1, 3);
  CloudChunk second = ChunkOf(1, 1, 5);
  first.cloud.organised = second.cloud.organised = false;
  second.sweep_lines = 100'000'000;  // what it is said to have beside these is nothing to fill up
  const Cloud sweep = JoinChunks({first, second});
  EXPECT_FALSE(sweep.organised);
  EXPECT_EQ(sweep.origins.size(), first.cloud.origins.empty() ? 0U : 1U);
  EXPECT_EQ(sweep.lines, 1);
  EXPECT_EQ(sweep.beams, 8);
  EXPECT_EQ(sweep.size(), 8U);
}

TEST(JoinChunks, TheEmptyChunkThatEndsASweepAddsNothing) {
  CloudChunk end;
  end.sweep_end = true;
  EXPECT_THAT(LinesOf(JoinChunks({ChunkOf(0, 2, 3), end})), ElementsAre(0, 1));
  EXPECT_EQ(JoinChunks({end}).size(), 0U);
  EXPECT_EQ(JoinChunks({}).size(), 0U);
}

TEST(JoinChunks, DifferentBeamsPerLineAreAnErrorWithBothNumbers) {
  const std::string message = InputErrorOf([] {
    JoinChunks({ChunkOf(0, 2, 3), ChunkOf(2, 1, 4)});
  });
  EXPECT_THAT(message, HasSubstr("3 and 4 beams"));
}

TEST(JoinChunks, ChunksThatFillOtherVectorsAreAnError) {
  CloudChunk without_times = ChunkOf(2, 1, 3);
  without_times.cloud.utime.clear();
  const std::string message = InputErrorOf([&] { JoinChunks({ChunkOf(0, 2, 3), without_times}); });
  EXPECT_THAT(message, HasSubstr("differ in what they tell"));
}

}  // namespace
}  // namespace rgbdt
