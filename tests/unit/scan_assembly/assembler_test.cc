#include "calib/scan_assembly/assembler.h"

#include <algorithm>
#include <random>
#include <utility>
#include <variant>

#include "tests/numbers.h"
#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

using ::testing::HasSubstr;

using Input = std::variant<LineScan, EncoderReading>;
using Inputs = std::vector<Input>;
using Chunks = std::vector<CloudChunk>;

constexpr Utime kMs = 1000;
constexpr int kLines = 25;
constexpr Utime kLinePeriod = 40 * kMs;
constexpr Utime kSweepEnd = kSweep + kLines * kLinePeriod;

TurnedScanner MakeScanner() {
  TurnedScanner scanner;
  scanner.motor_from_scanner = RotationAbout({0.2, 1, -0.4}, 0.05);
  scanner.motor_from_scanner.translation = {0.03, -0.02, 0.11};
  scanner.ticks_per_rad = 1e4;
  scanner.zero_ticks = 100000;
  return scanner;
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

// The motor turns 1 rad/s; between sweeps sweep_utime is 0.
EncoderReading Reading(Utime utime, Utime sweep = kSweep, Utime sweep_end = kSweepEnd) {
  EncoderReading reading;
  reading.utime = utime;
  reading.ticks = 100000 + (utime - sweep) / 100;
  reading.sweep_utime = utime >= sweep && utime <= sweep_end ? sweep : 0;
  return reading;
}

// A sweep in the order in which a real rig would say it: each line after its last beam.
Inputs SweepInOrder(Utime sweep = kSweep, std::int64_t first_seq = 0) {
  const Utime end = sweep + kLines * kLinePeriod;
  Inputs messages;
  int line = 0;
  for (Utime t = sweep - 100 * kMs; t <= end + 250 * kMs; t += 10 * kMs) {
    while (line < kLines && sweep + (line + 1) * kLinePeriod <= t) {
      messages.push_back(Line(line++, sweep, first_seq));
    }
    messages.push_back(Reading(t, sweep, end));
  }
  return messages;
}

std::size_t PlaceOfLine(const Inputs& messages, int line) {
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const auto* scan = std::get_if<LineScan>(&messages[i]);
    if (scan != nullptr && scan->seq == line) return i;
  }
  return messages.size();
}

Utime UtimeOf(const Input& input) {
  return std::visit([](const auto& in) { return in.utime; }, input);
}

Chunks AddTo(Assembler* assembler, const Input& input) {
  return std::visit([&](const auto& in) { return assembler->Add(in); }, input);
}

Chunks AddAll(Assembler* assembler, const Inputs& inputs) {
  Chunks out;
  for (const Input& input : inputs) {
    for (CloudChunk& chunk : AddTo(assembler, input)) out.push_back(std::move(chunk));
  }
  return out;
}

template <typename T>
std::string BytesOf(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

// Equal where two chunks are the same, bit for bit.
std::string BytesOf(const CloudChunk& chunk) {
  const Cloud& cloud = chunk.cloud;
  const std::vector<std::int64_t> numbers = {
      cloud.sweep_utime, cloud.first_line, cloud.lines, cloud.beams, std::int64_t{chunk.sweep_end},
      chunk.sweep_lines, chunk.lines_lost};
  return BytesOf(numbers) + BytesOf(cloud.points) + BytesOf(cloud.directions) +
         BytesOf(cloud.origins) + BytesOf(cloud.intensity) + BytesOf(cloud.utime) +
         BytesOf(cloud.ring);
}

std::vector<std::string> BytesOfAll(const Chunks& chunks) {
  std::vector<std::string> bytes;
  for (const CloudChunk& chunk : chunks) bytes.push_back(BytesOf(chunk));
  return bytes;
}

class AssemblerTest : public ::testing::Test {
 protected:
  // What comes back; what is refused is kept in problems_.
  Chunks Feed(const Inputs& inputs) {
    Chunks out;
    for (const Input& input : inputs) {
      try {
        for (CloudChunk& chunk : AddTo(&assembler_, input)) out.push_back(std::move(chunk));
      } catch (const InputError& e) {
        problems_.emplace_back(e.what());
      }
    }
    return out;
  }
  std::int64_t LinesLost() const { return assembler_.counts().lines_lost; }

  Assembler assembler_{MakeScanner()};
  std::vector<std::string> problems_;
};

TEST(Assembler, AnEncodersDelayThatTheRigHasIsTakenOffBitForBit) {
  for (const Utime late : {30 * kMs, 90 * kMs, -20 * kMs, -90 * kMs}) {
    Inputs inputs = SweepInOrder();
    for (Input& input : inputs) {
      auto* reading = std::get_if<EncoderReading>(&input);
      if (reading == nullptr) continue;
      reading->utime += late;
      if (reading->sweep_utime != 0) reading->sweep_utime += late;  // a sweep's name is as stamped
    }
    TurnedScanner scanner = MakeScanner();
    Assembler as_stamped(scanner);
    scanner.encoder_delay_s = ToSeconds(late);
    Assembler on_time(scanner);
    Assembler right(MakeScanner());
    const auto bytes_but_for_the_name = [&](Assembler* assembler) {
      Chunks chunks = AddAll(assembler, inputs);
      for (CloudChunk& chunk : chunks) chunk.cloud.sweep_utime -= late;
      return BytesOfAll(chunks);
    };
    const auto expected = BytesOfAll(AddAll(&right, SweepInOrder()));
    EXPECT_EQ(bytes_but_for_the_name(&on_time), expected);
    EXPECT_EQ(on_time.counts().lines_lost, 0);
    EXPECT_NE(bytes_but_for_the_name(&as_stamped), expected);
  }
}

TEST_F(AssemblerTest, ASweepIsItsLinesAndAnEnd) {
  const auto chunks = Feed(SweepInOrder());
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
  EXPECT_EQ(assembler_.counts().lines_used, kLines);
  EXPECT_EQ(assembler_.counts().sweeps, 1);
}

// Within kGrace, in whatever order lines come among themselves and against the readings.
TEST_F(AssemblerTest, TheOrderOfLinesAndReadingsDoesNotMatter) {
  const auto expected = BytesOfAll(Feed(SweepInOrder()));
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    std::vector<std::pair<Utime, Input>> timed;
    for (const Input& message : SweepInOrder()) {
      const bool line = std::holds_alternative<LineScan>(message);
      const Utime jitter = line ? static_cast<Utime>(random() % 90'000) - 40'000 : 0;
      timed.emplace_back(UtimeOf(message) + jitter, message);
    }
    std::stable_sort(timed.begin(), timed.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    Inputs shuffled;
    for (auto& [at, message] : timed) shuffled.push_back(std::move(message));
    Assembler fresh(MakeScanner());
    EXPECT_EQ(BytesOfAll(AddAll(&fresh, shuffled)), expected) << "seed " << seed;
  }
}

TEST_F(AssemblerTest, AllLinesBeforeAllReadingsGiveTheSame) {
  const auto expected = BytesOfAll(Feed(SweepInOrder()));
  Inputs lines_first = SweepInOrder();
  std::stable_partition(lines_first.begin(), lines_first.end(), [](const Input& message) {
    return std::holds_alternative<LineScan>(message);
  });
  Assembler fresh(MakeScanner());
  EXPECT_EQ(BytesOfAll(AddAll(&fresh, lines_first)), expected);
}

TEST_F(AssemblerTest, AChunkLeavesWithTheReadingAtItsLastBeam) {
  Inputs messages = SweepInOrder();
  const std::size_t tenth = PlaceOfLine(messages, 10);
  Feed(Inputs(messages.begin(), messages.begin() + static_cast<std::ptrdiff_t>(tenth)));
  const Utime end = Line(10).utime + 8 * 4 * kMs;
  EXPECT_TRUE(assembler_.Add(Line(10)).empty());
  EXPECT_TRUE(assembler_.Add(Line(11)).empty());
  const auto chunks = assembler_.Add(Reading(end));
  ASSERT_EQ(chunks.size(), 1U);
  EXPECT_EQ(chunks.front().cloud.first_line, 10);
  // Where the reading is there already, with the line.
  EXPECT_TRUE(assembler_.Add(Line(12)).empty());
  Feed({Reading(end + 80 * kMs)});
  EXPECT_EQ(assembler_.Add(Line(13)).size(), 0U);
  Feed({Reading(end + 170 * kMs)});
  EXPECT_EQ(assembler_.Add(Line(14)).size(), 1U);
}

TEST_F(AssemblerTest, ASweepDoesNotEndAtItsOwnStart) {
  Inputs messages = SweepInOrder();
  messages.resize(PlaceOfLine(messages, 8));
  const auto chunks = Feed(messages);
  ASSERT_FALSE(chunks.empty());
  for (const CloudChunk& chunk : chunks) EXPECT_FALSE(chunk.sweep_end);
  EXPECT_EQ(assembler_.counts().sweeps, 0);
}

TEST_F(AssemblerTest, EndsWithTheGraceForLateLines) {
  Inputs messages = SweepInOrder();
  messages.erase(messages.begin() + static_cast<std::ptrdiff_t>(PlaceOfLine(messages, 24)));
  Inputs before;
  for (const Input& message : messages) {
    if (UtimeOf(message) < kSweepEnd + Assembler::kGrace) before.push_back(message);
  }
  for (const auto& chunk : Feed(before)) EXPECT_FALSE(chunk.sweep_end);
  EXPECT_EQ(Feed({Line(24)}).size(), 1U);  // late, but not too late
  Utime t = kSweepEnd + Assembler::kGrace;
  std::vector<CloudChunk> end;
  for (; end.empty() && t < kSweepEnd + 300 * kMs; t += 10 * kMs) {
    end = Feed({Reading(t)});
  }
  ASSERT_EQ(end.size(), 1U);
  EXPECT_TRUE(end.front().sweep_end);
  EXPECT_LE(t, kSweepEnd + Assembler::kGrace + 30 * kMs);
  EXPECT_EQ(end.front().lines_lost, 0);
}

TEST_F(AssemblerTest, ALineAfterItsSweepIsRefused) {
  Inputs messages = SweepInOrder();
  messages.erase(messages.begin() + static_cast<std::ptrdiff_t>(PlaceOfLine(messages, 20)));
  const auto chunks = Feed(messages);
  EXPECT_EQ(chunks.back().lines_lost, 1);
  EXPECT_THAT(InputErrorOf([&] { assembler_.Add(Line(20)); }),
              HasSubstr("after its sweep had ended"));
  EXPECT_EQ(LinesLost(), 1);
}

TEST_F(AssemblerTest, ADroppedLineIsCountedAndLeavesItsPlaceEmpty) {
  const auto whole = Feed(SweepInOrder());
  Inputs messages = SweepInOrder();
  messages.erase(messages.begin() + static_cast<std::ptrdiff_t>(PlaceOfLine(messages, 7)));
  Assembler fresh(MakeScanner());
  const auto chunks = AddAll(&fresh, messages);
  ASSERT_EQ(chunks.size(), static_cast<std::size_t>(kLines));
  EXPECT_EQ(chunks[7].cloud.first_line, 8);
  EXPECT_EQ(chunks.back().lines_lost, 1);
  EXPECT_EQ(chunks.back().sweep_lines, kLines);
  EXPECT_EQ(fresh.counts().lines_lost, 1);
  EXPECT_EQ(BytesOf(chunks[7]), BytesOf(whole[8]));
}

TEST_F(AssemblerTest, FirstLinesReorderedKeepTheirPlaces) {
  const auto expected = BytesOfAll(Feed(SweepInOrder()));
  Inputs messages = SweepInOrder();
  std::swap(messages[PlaceOfLine(messages, 0)], messages[PlaceOfLine(messages, 1)]);
  Assembler fresh(MakeScanner());
  EXPECT_EQ(BytesOfAll(AddAll(&fresh, messages)), expected);
}

// What came before is unknown: lines keep the places that they have in the whole sweep.
TEST_F(AssemblerTest, StartedInTheMidstOfASweepItKnowsWhatItMissed) {
  const auto whole = BytesOfAll(Feed(SweepInOrder(kSweep, 70)));
  for (const int missed : {1, 2, 12, kLines - 1}) {
    Inputs rest;
    for (const Input& message : SweepInOrder(kSweep, 70)) {
      if (UtimeOf(message) >= Line(missed).utime) rest.push_back(message);
    }
    Assembler fresh(MakeScanner());
    const auto chunks = AddAll(&fresh, rest);
    ASSERT_EQ(chunks.size(), static_cast<std::size_t>(kLines - missed) + 1);
    for (int i = missed; i < kLines; ++i) {
      const std::size_t at = static_cast<std::size_t>(i - missed);
      const bool same = BytesOf(chunks[at]) == whole[static_cast<std::size_t>(i)];
      // The last line alone does not tell how far apart lines are: its beams take 32 of 40 ms.
      EXPECT_EQ(same, missed < kLines - 1) << missed << " " << i;
    }
    EXPECT_GE(chunks.back().lines_lost, missed);
    EXPECT_EQ(chunks.back().lines_lost, chunks.back().sweep_lines - (kLines - missed));
    EXPECT_EQ(fresh.counts().lines_lost, chunks.back().lines_lost);
  }
}

TEST_F(AssemblerTest, FirstLinesThatWereLostOnTheWayAreCountedByTheirNumbers) {
  Feed(SweepInOrder());
  const Utime second = kSweep + 5 * kMicrosecondsPerSecond;
  Inputs messages = SweepInOrder(second, kLines);
  for (const int lost : {0, 1}) {
    messages.erase(messages.begin() +
                   static_cast<std::ptrdiff_t>(PlaceOfLine(messages, kLines + lost)));
  }
  const auto chunks = Feed(messages);
  EXPECT_EQ(chunks.front().cloud.first_line, 2);
  EXPECT_EQ(chunks.back().lines_lost, 2);
}

// A scanner that runs on between sweeps: its first line lies anywhere after the sweep's start.
TEST_F(AssemblerTest, ALineShortlyBeforeTheSweepIsNoLineThatItLacks) {
  Inputs messages;
  for (Utime t = kSweep - 300 * kMs; t <= kSweepEnd + 300 * kMs; t += 10 * kMs) {
    const Utime since = t - (kSweep - 300 * kMs);
    if (since % kLinePeriod == 20 * kMs) {
      LineScan line = Line(static_cast<int>(since / kLinePeriod));
      line.utime = t - 1 - kLinePeriod;  // 1 us before the sweep, then 39.999 ms after its start
      messages.push_back(line);
    }
    messages.push_back(Reading(t));
  }
  const auto chunks = Feed(messages);
  ASSERT_GT(chunks.size(), 20U);
  EXPECT_EQ(chunks.front().cloud.first_line, 0);
  EXPECT_EQ(chunks.front().cloud.utime.front(), kSweep + kLinePeriod - 1);
  EXPECT_EQ(chunks.back().lines_lost, 0);
}

TEST_F(AssemblerTest, AReadingOutOfOrderIsRefusedAndTheSweepGoesOn) {
  Inputs messages = SweepInOrder();
  // Two readings in the middle of the sweep change places: the older then comes too late.
  const std::size_t i = PlaceOfLine(messages, 12) + 1;
  ASSERT_TRUE(std::holds_alternative<EncoderReading>(messages[i]));
  ASSERT_TRUE(std::holds_alternative<EncoderReading>(messages[i + 1]));
  std::swap(messages[i], messages[i + 1]);
  const auto chunks = Feed(messages);
  EXPECT_THAT(problems_, ::testing::ElementsAre(HasSubstr("is not after the one before it")));
  EXPECT_EQ(chunks.size(), kLines + 1U);
  EXPECT_EQ(chunks.back().lines_lost, 0);
}

TEST_F(AssemblerTest, ALostReadingAtTheStartLosesNoLine) {
  Inputs messages = SweepInOrder();
  messages.erase(std::find_if(messages.begin(), messages.end(), [](const Input& message) {
    const auto* reading = std::get_if<EncoderReading>(&message);
    return reading != nullptr && reading->utime == kSweep;
  }));
  const auto chunks = Feed(messages);
  EXPECT_EQ(chunks.size(), kLines + 1U);
  EXPECT_EQ(chunks.front().cloud.utime.front(), kSweep);
}

TEST_F(AssemblerTest, LinesWithoutAnglesAreLost) {
  // No reading for 150 ms, more than kMaxGap, in the midst of the sweep and again at its end.
  Inputs messages;
  for (const Input& message : SweepInOrder()) {
    const Utime at = UtimeOf(message) - kSweep;
    const bool gone = (at > 400 * kMs && at < 550 * kMs) || (at > 890 * kMs && at < 1040 * kMs);
    if (!gone || !std::holds_alternative<EncoderReading>(message)) messages.push_back(message);
  }
  const auto chunks = Feed(messages);
  ASSERT_TRUE(chunks.back().sweep_end);
  EXPECT_EQ(chunks.back().sweep_lines, kLines);
  EXPECT_EQ(chunks.back().lines_lost, kLines - static_cast<int>(chunks.size()) + 1);
  EXPECT_GE(chunks.back().lines_lost, 6);
  EXPECT_LE(chunks.back().lines_lost, 10);
  EXPECT_EQ(LinesLost(), chunks.back().lines_lost);
}

TEST_F(AssemblerTest, DuplicatesAreRefusedAndChangeNothing) {
  const auto expected = BytesOfAll(Feed(SweepInOrder()));
  Inputs twice;
  for (const Input& message : SweepInOrder()) {
    twice.push_back(message);
    twice.push_back(message);
  }
  Assembler fresh(MakeScanner());
  std::swap(assembler_, fresh);
  EXPECT_EQ(BytesOfAll(Feed(twice)), expected);
  EXPECT_EQ(problems_.size(), twice.size() / 2);
  EXPECT_EQ(LinesLost(), 0);
}

TEST_F(AssemblerTest, AnotherScannerForgetsTheSweepAtHand) {
  Inputs messages = SweepInOrder();
  messages.resize(PlaceOfLine(messages, 12));
  Feed(messages);
  ASSERT_TRUE(assembler_.LinesOfSweep().has_value());
  const std::int64_t used = assembler_.counts().lines_used;
  assembler_.SetScanner(MakeScanner());
  EXPECT_FALSE(assembler_.LinesOfSweep().has_value());
  EXPECT_EQ(assembler_.counts().lines_used, used);
  EXPECT_EQ(Feed(SweepInOrder()).size(), kLines + 1U);
}

TEST_F(AssemblerTest, SecondSweepFollowsWithItsOwnPlaces) {
  Feed(SweepInOrder());
  const Utime second = kSweep + 5 * kMicrosecondsPerSecond;
  const auto chunks = Feed(SweepInOrder(second, kLines));
  ASSERT_EQ(chunks.size(), kLines + 1U);
  EXPECT_EQ(chunks.front().cloud.first_line, 0);
  EXPECT_EQ(chunks.front().cloud.sweep_utime, second);
  EXPECT_EQ(chunks.back().cloud.sweep_utime, second);
}

TEST_F(AssemblerTest, LinesOfTheNextSweepEndTheOneBefore) {
  // Without a pause: the encoder names the second sweep from the first's last reading on.
  Inputs messages;
  for (Utime t = kSweep; t <= kSweepEnd + kLines * kLinePeriod; t += 10 * kMs) {
    EncoderReading reading = Reading(t);
    reading.sweep_utime = t < kSweepEnd ? kSweep : kSweepEnd;
    messages.push_back(reading);
    if ((t - kSweep) % kLinePeriod == 0 && t > kSweep) {
      messages.push_back(Line(static_cast<int>((t - kSweep) / kLinePeriod) - 1));
    }
  }
  const auto chunks = Feed(messages);
  const auto end = std::find_if(chunks.begin(), chunks.end(),
                                [](const CloudChunk& chunk) { return chunk.sweep_end; });
  ASSERT_NE(end, chunks.end());
  EXPECT_EQ(end - chunks.begin(), kLines);
  EXPECT_EQ(end->cloud.sweep_utime, kSweep);
  ASSERT_GT(chunks.end() - end, 10);
  EXPECT_EQ((end + 1)->cloud.sweep_utime, kSweepEnd);
  EXPECT_EQ((end + 1)->cloud.first_line, 0);
}

TEST_F(AssemblerTest, AFirstLineDoesNotWaitWhereAllBeforeItHasCome) {
  const Utime second = kSweep + 5 * kMicrosecondsPerSecond;
  const auto first_chunk = [&](std::int64_t first_seq) {
    Utime newest = 0;
    for (const Input& message : SweepInOrder(second, first_seq)) {
      if (std::holds_alternative<EncoderReading>(message)) newest = UtimeOf(message);
      if (!Feed({message}).empty()) return newest;
    }
    return Utime{0};
  };
  const Utime end = second + 8 * 4 * kMs;
  Feed(SweepInOrder());
  EXPECT_LT(first_chunk(kLines), end + 10 * kMs + kLinePeriod);
  // Where a number is missing before it, it could be that of the sweep's first line.
  Assembler other(MakeScanner());
  std::swap(assembler_, other);
  Feed(SweepInOrder());
  EXPECT_GE(first_chunk(kLines + 1), end + Assembler::kGrace);
}

// Without a pause, the first sweep's last lines late: they still have their time to come.
TEST_F(AssemblerTest, AnIncompleteSweepKeepsItsGraceWhenTheNextBegins) {
  Inputs messages;
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
  const auto chunks = Feed(messages);
  const auto end = std::find_if(chunks.begin(), chunks.end(),
                                [](const CloudChunk& chunk) { return chunk.sweep_end; });
  ASSERT_NE(end, chunks.end());
  EXPECT_EQ(end - chunks.begin(), kLines);
  EXPECT_EQ(end->lines_lost, 0);
  EXPECT_THAT(problems_, ::testing::IsEmpty());
}

TEST_F(AssemblerTest, LinesWithoutReadingsAreBounded) {
  const int many = static_cast<int>(Assembler::kMaxWaiting) + 200;
  for (int i = 0; i < many; ++i) EXPECT_TRUE(Feed({Line(i)}).empty());
  EXPECT_EQ(LinesLost(), 200);
  EXPECT_TRUE(problems_.empty());
}

// Lines and readings alike: they bear the times of one clock.
TEST_F(AssemblerTest, AClockSetInTheMidstOfASweepSpoilsNoLaterOne) {
  for (const Utime jump_ms : {-10'000, -1000, -200, 200, 1000, 10'000}) {
    assembler_ = Assembler(MakeScanner());
    Inputs spoilt = SweepInOrder();
    for (Input& input : spoilt) {
      if (UtimeOf(input) < kSweep + kLines / 2 * kLinePeriod) continue;
      std::visit([&](auto& in) { in.utime += jump_ms * kMs; }, input);
    }
    Feed(spoilt);
    const Inputs next = SweepInOrder(kSweep + 30'000 * kMs + jump_ms * kMs, kLines);
    problems_.clear();
    const Chunks chunks = Feed(next);
    EXPECT_TRUE(problems_.empty()) << jump_ms << ": " << problems_.front();
    Assembler undisturbed(MakeScanner());
    const Chunks expected = AddAll(&undisturbed, next);
    ASSERT_EQ(expected.size(), kLines + 1U);
    ASSERT_GE(chunks.size(), expected.size()) << jump_ms;
    // The spoilt sweep may end with the next one's first reading.
    const Chunks newest(chunks.end() - static_cast<long>(expected.size()), chunks.end());
    EXPECT_EQ(BytesOfAll(newest), BytesOfAll(expected)) << jump_ms;
  }
}

// They were sent after those whose times they bear once more: their angles are not known.
TEST_F(AssemblerTest, LinesOfTimesThatHaveBeenAreMissingInTheSweep) {
  Inputs set_back = SweepInOrder();
  for (Input& input : set_back) {
    if (UtimeOf(input) < kSweep + kLines / 2 * kLinePeriod) continue;
    std::visit([&](auto& in) { in.utime -= 5 * kLinePeriod; }, input);
  }
  const auto chunks = Feed(set_back);
  ASSERT_TRUE(chunks.back().sweep_end);
  EXPECT_EQ(chunks.back().sweep_lines, kLines);
  EXPECT_EQ(chunks.back().lines_lost, 5);
  EXPECT_THAT(problems_, ::testing::Contains(HasSubstr("a clock was set back")));
}

TEST_F(AssemblerTest, AfterAClockThatIsSetBackItIsDeafUntilThatIsWhereItWas) {
  const auto chunks = Feed(SweepInOrder());
  ASSERT_EQ(chunks.size(), kLines + 1U);
  EXPECT_TRUE(Feed(SweepInOrder()).empty()) << "a short log looped: the same times once more";
  EXPECT_THAT(problems_, ::testing::Contains(HasSubstr("is not after the one before it")));
  problems_.clear();
  EXPECT_EQ(Feed(SweepInOrder(kSweepEnd + 1000 * kMs, kLines)).size(), kLines + 1U);
  EXPECT_TRUE(problems_.empty());
}

TEST_F(AssemblerTest, AClockSetBackBeginsAnew) {
  // A reading of the far future: a broken clock, or a lie. Then the sweep as if nothing had been.
  Feed({Reading(kSweep + 1'000'000'000'000)});
  const auto chunks = Feed(SweepInOrder());
  EXPECT_EQ(chunks.size(), kLines + 1U);
  // The rig starts again: the same sweep once more.
  EXPECT_EQ(Feed({Reading(kSweep + 20'000'000)}).size(), 0U);
  EXPECT_EQ(BytesOfAll(Feed(SweepInOrder())).size(), kLines + 1U);
}

}  // namespace
}  // namespace rgbdt
