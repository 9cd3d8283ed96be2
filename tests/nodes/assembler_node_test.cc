#include "services/nodes/assembler_node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "calib/model/errors.h"
#include "tests/nodes/nodes_testing.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using test::BytesOf;
using test::Counter;
using test::ErrorOf;
using test::Only;
using ::testing::HasSubstr;

constexpr Utime kSweep = 1'500'000'000'000'000;
constexpr Utime kMs = 1000;
constexpr int kLines = 25;
constexpr Utime kLinePeriod = 40 * kMs;
constexpr Utime kSweepEnd = kSweep + kLines * kLinePeriod;

RigText MakeRigText() {
  static const RigText text = test::TextOf(test::RigOf(simulate::Simulator(test::TinyOptions())));
  return text;
}

// Line i of a sweep, 8 beams in 32 ms; ranges tell line and beam, one beam returned nothing.
LineScan Line(int i, Utime sweep = kSweep, std::int64_t first_seq = 0) {
  LineScan line;
  line.utime = sweep + i * kLinePeriod;
  line.seq = first_seq + i;
  line.beam_period_s = 0.004;
  line.first_angle_rad = -0.5;
  line.angle_step_rad = 0.1;
  for (int beam = 0; beam < 8; ++beam) {
    line.range.push_back(beam == 3 ? NAN : 1.0F + 0.1F * static_cast<float>(i * 8 + beam));
    line.intensity.push_back(0.5F);
  }
  return line;
}

// The motor turns 1 rad/s, 1400 ticks a degree or so; between sweeps sweep_utime is 0.
EncoderReading Reading(Utime utime, Utime sweep = kSweep, Utime sweep_end = kSweepEnd) {
  EncoderReading reading;
  reading.utime = utime;
  reading.ticks = 100000 + (utime - sweep) / 100;
  reading.sweep_utime = utime >= sweep && utime <= sweep_end ? sweep : 0;
  return reading;
}

// A sweep in the order in which a real rig would say it: each line after its last beam.
Messages SweepInOrder(Utime sweep = kSweep, std::int64_t first_seq = 0) {
  const Utime end = sweep + kLines * kLinePeriod;
  Messages messages;
  int line = 0;
  for (Utime t = sweep - 100 * kMs; t <= end + 250 * kMs; t += 10 * kMs) {
    while (line < kLines && sweep + (line + 1) * kLinePeriod <= t) {
      messages.push_back(Line(line++, sweep, first_seq));
    }
    messages.push_back(Reading(t, sweep, end));
  }
  return messages;
}

std::size_t PlaceOfLine(const Messages& messages, int line) {
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const auto* scan = std::get_if<LineScan>(&messages[i]);
    if (scan != nullptr && scan->seq == line) return i;
  }
  return messages.size();
}

class AssemblerNodeTest : public ::testing::Test {
 protected:
  AssemblerNodeTest() { node_.Handle(MakeRigText()); }

  // What comes back; what is refused is kept in problems_, as NodeRunner would.
  Messages Feed(const Messages& messages) {
    Messages out;
    for (const Message& message : messages) {
      try {
        for (Message& answer : node_.Handle(message)) out.push_back(std::move(answer));
      } catch (const InputError& e) {
        problems_.push_back(e.what());
      }
    }
    return out;
  }
  std::int64_t LinesLost() const { return Counter(node_.GetStatus(), "lines lost"); }

  AssemblerNode node_;
  std::vector<std::string> problems_;
};

TEST_F(AssemblerNodeTest, ASweepIsItsLinesAndAnEnd) {
  const auto chunks = Only<CloudChunk>(Feed(SweepInOrder()));
  ASSERT_EQ(chunks.size(), kLines + 1U);
  for (int i = 0; i < kLines; ++i) {
    const CloudChunk& chunk = chunks[static_cast<std::size_t>(i)];
    EXPECT_EQ(chunk.cloud.first_line, i);
    EXPECT_EQ(chunk.cloud.sweep_utime, kSweep);
    EXPECT_EQ(chunk.cloud.utime.front(), Line(i).utime);
    EXPECT_FALSE(chunk.sweep_end);
    EXPECT_EQ(chunk.cloud.size(), 8U);
    EXPECT_FALSE(chunk.cloud.IsHit(3));
    EXPECT_NEAR(chunk.cloud.directions[3].norm(), 1, 1e-6);
  }
  EXPECT_TRUE(chunks.back().sweep_end);
  EXPECT_EQ(chunks.back().sweep_lines, kLines);
  EXPECT_EQ(chunks.back().lines_lost, 0);
  EXPECT_THAT(problems_, ::testing::IsEmpty());
  EXPECT_EQ(Counter(node_.GetStatus(), "lines"), kLines);
  EXPECT_EQ(Counter(node_.GetStatus(), "sweeps"), 1);
}

// Within kGrace, in whatever order lines come among themselves and against the readings.
TEST_F(AssemblerNodeTest, TheOrderOfLinesAndReadingsDoesNotMatter) {
  const std::vector<Bytes> expected = BytesOf(Feed(SweepInOrder()));
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    std::vector<std::pair<Utime, Message>> timed;
    for (const Message& message : SweepInOrder()) {
      const bool line = std::holds_alternative<LineScan>(message);
      const Utime jitter = line ? static_cast<Utime>(random() % 90'000) - 40'000 : 0;
      timed.emplace_back(UtimeOf(message) + jitter, message);
    }
    std::stable_sort(timed.begin(), timed.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    Messages shuffled;
    for (auto& [at, message] : timed) shuffled.push_back(std::move(message));
    AssemblerNode node;
    node.Handle(MakeRigText());
    EXPECT_EQ(BytesOf(test::HandleAll(&node, shuffled)), expected) << "seed " << seed;
  }
}

TEST_F(AssemblerNodeTest, AllLinesBeforeAllReadingsGiveTheSame) {
  const std::vector<Bytes> expected = BytesOf(Feed(SweepInOrder()));
  Messages lines_first = SweepInOrder();
  std::stable_partition(lines_first.begin(), lines_first.end(), [](const Message& message) {
    return std::holds_alternative<LineScan>(message);
  });
  AssemblerNode node;
  node.Handle(MakeRigText());
  EXPECT_EQ(BytesOf(test::HandleAll(&node, lines_first)), expected);
}

TEST_F(AssemblerNodeTest, AChunkLeavesWithTheReadingAtItsLastBeam) {
  Messages messages = SweepInOrder();
  const std::size_t tenth = PlaceOfLine(messages, 10);
  Feed(Messages(messages.begin(), messages.begin() + static_cast<std::ptrdiff_t>(tenth)));
  const Utime end = Line(10).utime + 8 * 4 * kMs;
  EXPECT_TRUE(node_.Handle(Line(10)).empty());
  EXPECT_TRUE(node_.Handle(Line(11)).empty());
  const auto chunks = Only<CloudChunk>(node_.Handle(Reading(end)));
  ASSERT_EQ(chunks.size(), 1U);
  EXPECT_EQ(chunks.front().cloud.first_line, 10);
  // Where the reading is there already, with the line.
  EXPECT_TRUE(node_.Handle(Line(12)).empty());
  Feed({Reading(end + 80 * kMs)});
  EXPECT_EQ(Only<CloudChunk>(node_.Handle(Line(13))).size(), 0U);
  Feed({Reading(end + 170 * kMs)});
  EXPECT_EQ(Only<CloudChunk>(node_.Handle(Line(14))).size(), 1U);
}

TEST_F(AssemblerNodeTest, ASweepDoesNotEndAtItsOwnStart) {
  Messages messages = SweepInOrder();
  messages.resize(PlaceOfLine(messages, 8));
  const auto chunks = Only<CloudChunk>(Feed(messages));
  ASSERT_FALSE(chunks.empty());
  for (const CloudChunk& chunk : chunks) EXPECT_FALSE(chunk.sweep_end);
  EXPECT_EQ(Counter(node_.GetStatus(), "sweeps"), 0);
}

TEST_F(AssemblerNodeTest, EndsWithTheGraceForLateLines) {
  Messages messages = SweepInOrder();
  messages.erase(messages.begin() + static_cast<std::ptrdiff_t>(PlaceOfLine(messages, 24)));
  Messages before;
  for (const Message& message : messages) {
    if (UtimeOf(message) < kSweepEnd + AssemblerNode::kGrace) before.push_back(message);
  }
  for (const auto& chunk : Only<CloudChunk>(Feed(before))) EXPECT_FALSE(chunk.sweep_end);
  EXPECT_EQ(Only<CloudChunk>(Feed({Line(24)})).size(), 1U);  // late, but not too late
  Utime t = kSweepEnd + AssemblerNode::kGrace;
  std::vector<CloudChunk> end;
  for (; end.empty() && t < kSweepEnd + 300 * kMs; t += 10 * kMs) {
    end = Only<CloudChunk>(Feed({Reading(t)}));
  }
  ASSERT_EQ(end.size(), 1U);
  EXPECT_TRUE(end.front().sweep_end);
  EXPECT_LE(t, kSweepEnd + AssemblerNode::kGrace + 30 * kMs);
  EXPECT_EQ(end.front().lines_lost, 0);
}

TEST_F(AssemblerNodeTest, ALineAfterItsSweepIsRefused) {
  Messages messages = SweepInOrder();
  messages.erase(messages.begin() + static_cast<std::ptrdiff_t>(PlaceOfLine(messages, 20)));
  const auto chunks = Only<CloudChunk>(Feed(messages));
  EXPECT_EQ(chunks.back().lines_lost, 1);
  EXPECT_THAT(ErrorOf([&] { node_.Handle(Line(20)); }), HasSubstr("after its sweep had ended"));
  EXPECT_EQ(LinesLost(), 1);
}

TEST_F(AssemblerNodeTest, ADroppedLineIsCountedAndLeavesItsPlaceEmpty) {
  const auto whole = Only<CloudChunk>(Feed(SweepInOrder()));
  Messages messages = SweepInOrder();
  messages.erase(messages.begin() + static_cast<std::ptrdiff_t>(PlaceOfLine(messages, 7)));
  AssemblerNode node;
  node.Handle(MakeRigText());
  const auto chunks = Only<CloudChunk>(test::HandleAll(&node, messages));
  ASSERT_EQ(chunks.size(), static_cast<std::size_t>(kLines));
  EXPECT_EQ(chunks[7].cloud.first_line, 8);
  EXPECT_EQ(chunks.back().lines_lost, 1);
  EXPECT_EQ(chunks.back().sweep_lines, kLines);
  EXPECT_EQ(Counter(node.GetStatus(), "lines lost"), 1);
  EXPECT_EQ(Encode(chunks[7]), Encode(whole[8]));
}

TEST_F(AssemblerNodeTest, FirstLinesReorderedKeepTheirPlaces) {
  const std::vector<Bytes> expected = BytesOf(Feed(SweepInOrder()));
  Messages messages = SweepInOrder();
  std::swap(messages[PlaceOfLine(messages, 0)], messages[PlaceOfLine(messages, 1)]);
  AssemblerNode node;
  node.Handle(MakeRigText());
  EXPECT_EQ(BytesOf(test::HandleAll(&node, messages)), expected);
}

TEST_F(AssemblerNodeTest, AReadingOutOfOrderIsRefusedAndTheSweepGoesOn) {
  Messages messages = SweepInOrder();
  // Two readings in the middle of the sweep change places: the older then comes too late.
  const std::size_t i = PlaceOfLine(messages, 12) + 1;
  ASSERT_TRUE(std::holds_alternative<EncoderReading>(messages[i]));
  ASSERT_TRUE(std::holds_alternative<EncoderReading>(messages[i + 1]));
  std::swap(messages[i], messages[i + 1]);
  const auto chunks = Only<CloudChunk>(Feed(messages));
  EXPECT_THAT(problems_, ::testing::ElementsAre(HasSubstr("is not after the one before it")));
  EXPECT_EQ(chunks.size(), kLines + 1U);
  EXPECT_EQ(chunks.back().lines_lost, 0);
}

TEST_F(AssemblerNodeTest, ALostReadingAtTheStartLosesNoLine) {
  Messages messages = SweepInOrder();
  messages.erase(std::find_if(messages.begin(), messages.end(), [](const Message& message) {
    const auto* reading = std::get_if<EncoderReading>(&message);
    return reading != nullptr && reading->utime == kSweep;
  }));
  const auto chunks = Only<CloudChunk>(Feed(messages));
  EXPECT_EQ(chunks.size(), kLines + 1U);
  EXPECT_EQ(chunks.front().cloud.utime.front(), kSweep);
}

TEST_F(AssemblerNodeTest, LinesWithoutAnglesAreLost) {
  // No reading for 150 ms, more than kMaxGap, in the midst of the sweep and again at its end.
  Messages messages;
  for (const Message& message : SweepInOrder()) {
    const Utime at = UtimeOf(message) - kSweep;
    const bool gone = (at > 400 * kMs && at < 550 * kMs) || (at > 890 * kMs && at < 1040 * kMs);
    if (!gone || !std::holds_alternative<EncoderReading>(message)) messages.push_back(message);
  }
  const auto chunks = Only<CloudChunk>(Feed(messages));
  ASSERT_TRUE(chunks.back().sweep_end);
  EXPECT_EQ(chunks.back().sweep_lines, kLines);
  EXPECT_EQ(chunks.back().lines_lost, kLines - static_cast<int>(chunks.size()) + 1);
  EXPECT_GE(chunks.back().lines_lost, 6);
  EXPECT_LE(chunks.back().lines_lost, 10);
  EXPECT_EQ(LinesLost(), chunks.back().lines_lost);
}

TEST_F(AssemblerNodeTest, DuplicatesAreRefusedAndChangeNothing) {
  const std::vector<Bytes> expected = BytesOf(Feed(SweepInOrder()));
  Messages twice;
  for (const Message& message : SweepInOrder()) {
    twice.push_back(message);
    twice.push_back(message);
  }
  AssemblerNode node;
  node.Handle(MakeRigText());
  std::swap(node_, node);
  EXPECT_EQ(BytesOf(Feed(twice)), expected);
  EXPECT_EQ(problems_.size(), twice.size() / 2);
  EXPECT_EQ(LinesLost(), 0);
}

TEST(AssemblerNodeRigTest, BeforeTheRigNothingIsTaken) {
  AssemblerNode node;
  EXPECT_FALSE(node.GetStatus().ready);
  EXPECT_THAT(node.GetStatus().text, HasSubstr("rig"));
  EXPECT_THAT(ErrorOf([&] { node.Handle(Line(0)); }), HasSubstr("no rig heard yet"));
  EXPECT_THAT(ErrorOf([&] { node.Handle(Reading(kSweep)); }), HasSubstr("no rig heard yet"));
  EXPECT_THAT(ErrorOf([&] { node.Handle(RigText{0, "x", "name: 5"}); }), HasSubstr("RIG message"));
  EXPECT_FALSE(node.GetStatus().ready);
  node.Handle(MakeRigText());
  EXPECT_TRUE(node.GetStatus().ready);
  EXPECT_EQ(Only<CloudChunk>(test::HandleAll(&node, SweepInOrder())).size(), kLines + 1U);
}

TEST_F(AssemblerNodeTest, TheRigAgainDoesNotDisturbASweepAnotherRigEndsIt) {
  const std::vector<Bytes> expected = BytesOf(Feed(SweepInOrder()));
  Messages messages;
  for (const Message& message : SweepInOrder()) {
    messages.push_back(MakeRigText());
    messages.push_back(message);
  }
  AssemblerNode node;
  EXPECT_EQ(BytesOf(test::HandleAll(&node, messages)), expected);

  messages = SweepInOrder();
  messages.resize(PlaceOfLine(messages, 12));
  AssemblerNode other;
  other.Handle(MakeRigText());
  test::HandleAll(&other, messages);
  RigText another = MakeRigText();
  another.text += "# moved\n";
  another.hash = HashOfRigText(another.text);
  other.Handle(another);
  EXPECT_EQ(other.GetStatus().text, "waits for a sweep");
}

TEST_F(AssemblerNodeTest, SecondSweepFollowsWithItsOwnPlaces) {
  Feed(SweepInOrder());
  const Utime second = kSweep + 5 * kMicrosecondsPerSecond;
  const auto chunks = Only<CloudChunk>(Feed(SweepInOrder(second, kLines)));
  ASSERT_EQ(chunks.size(), kLines + 1U);
  EXPECT_EQ(chunks.front().cloud.first_line, 0);
  EXPECT_EQ(chunks.front().cloud.sweep_utime, second);
  EXPECT_EQ(chunks.back().cloud.sweep_utime, second);
}

TEST_F(AssemblerNodeTest, LinesOfTheNextSweepEndTheOneBefore) {
  // Without a pause: the encoder names the second sweep from the first's last reading on.
  Messages messages;
  for (Utime t = kSweep; t <= kSweepEnd + kLines * kLinePeriod; t += 10 * kMs) {
    EncoderReading reading = Reading(t);
    reading.sweep_utime = t < kSweepEnd ? kSweep : kSweepEnd;
    messages.push_back(reading);
    if ((t - kSweep) % kLinePeriod == 0 && t > kSweep) {
      messages.push_back(Line(static_cast<int>((t - kSweep) / kLinePeriod) - 1));
    }
  }
  const auto chunks = Only<CloudChunk>(Feed(messages));
  const auto end = std::find_if(chunks.begin(), chunks.end(),
                                [](const CloudChunk& chunk) { return chunk.sweep_end; });
  ASSERT_NE(end, chunks.end());
  EXPECT_EQ(end - chunks.begin(), kLines);
  EXPECT_EQ(end->cloud.sweep_utime, kSweep);
  ASSERT_GT(chunks.end() - end, 10);
  EXPECT_EQ((end + 1)->cloud.sweep_utime, kSweepEnd);
  EXPECT_EQ((end + 1)->cloud.first_line, 0);
}

TEST_F(AssemblerNodeTest, AFirstLineDoesNotWaitWhereAllBeforeItHasCome) {
  const Utime second = kSweep + 5 * kMicrosecondsPerSecond;
  const auto first_chunk = [&](std::int64_t first_seq) {
    Utime newest = 0;
    for (const Message& message : SweepInOrder(second, first_seq)) {
      if (std::holds_alternative<EncoderReading>(message)) newest = UtimeOf(message);
      if (!Only<CloudChunk>(Feed({message})).empty()) return newest;
    }
    return Utime{0};
  };
  const Utime end = second + 8 * 4 * kMs;
  Feed(SweepInOrder());
  EXPECT_LT(first_chunk(kLines), end + 10 * kMs + kLinePeriod);
  // Where a number is missing before it, it could be that of the sweep's first line.
  AssemblerNode other;
  other.Handle(MakeRigText());
  std::swap(node_, other);
  Feed(SweepInOrder());
  EXPECT_GE(first_chunk(kLines + 1), end + AssemblerNode::kGrace);
}

// Without a pause, the first sweep's last lines late: they still have their time to come.
TEST_F(AssemblerNodeTest, AnIncompleteSweepKeepsItsGraceWhenTheNextBegins) {
  Messages messages;
  for (Utime t = kSweep; t <= kSweepEnd + 400 * kMs; t += 10 * kMs) {
    EncoderReading reading = Reading(t);
    reading.sweep_utime = t < kSweepEnd ? kSweep : kSweepEnd;
    const int line = static_cast<int>((t - kSweep) / kLinePeriod) - 1;
    if ((t - kSweep) % kLinePeriod == 0 && line >= 0 && line != kLines - 2) {
      messages.push_back(Line(line));
    }
    messages.push_back(reading);
    if (t == kSweepEnd + 60 * kMs) messages.push_back(Line(kLines - 2));
  }
  const auto chunks = Only<CloudChunk>(Feed(messages));
  const auto end = std::find_if(chunks.begin(), chunks.end(),
                                [](const CloudChunk& chunk) { return chunk.sweep_end; });
  ASSERT_NE(end, chunks.end());
  EXPECT_EQ(end - chunks.begin(), kLines);
  EXPECT_EQ(end->lines_lost, 0);
  EXPECT_THAT(problems_, ::testing::IsEmpty());
}

TEST_F(AssemblerNodeTest, LinesWithoutReadingsAreBounded) {
  const int many = static_cast<int>(AssemblerNode::kMaxWaiting) + 200;
  for (int i = 0; i < many; ++i) EXPECT_TRUE(Feed({Line(i)}).empty());
  EXPECT_EQ(LinesLost(), 200);
  EXPECT_TRUE(problems_.empty());
}

TEST_F(AssemblerNodeTest, AClockSetBackBeginsAnew) {
  // A reading of the far future: a broken clock, or a lie. Then the sweep as if nothing had been.
  Feed({Reading(kSweep + 1'000'000'000'000)});
  const auto chunks = Only<CloudChunk>(Feed(SweepInOrder()));
  EXPECT_EQ(chunks.size(), kLines + 1U);
  // The rig starts again: the same sweep once more.
  EXPECT_EQ(Only<CloudChunk>(Feed({Reading(kSweep + 20'000'000)})).size(), 0U);
  EXPECT_EQ(BytesOf(Feed(SweepInOrder())).size(), kLines + 1U);
}

}  // namespace
}  // namespace rgbdt
