#include "services/nodes/assembler_node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calib/model/errors.h"
#include "tests/nodes/nodes_testing.h"
#include "tests/numbers.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using test::BytesOf;
using test::Counter;
using test::ErrorOf;
using test::Only;
using ::testing::HasSubstr;

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

TEST(AssemblerNodeTest, ASweepComesOutInChunksAndIsCounted) {
  AssemblerNode node;
  node.Handle(MakeRigText());
  const auto chunks = Only<CloudChunk>(test::HandleAll(&node, SweepInOrder()));
  ASSERT_EQ(chunks.size(), kLines + 1U);
  EXPECT_TRUE(chunks.back().sweep_end);
  EXPECT_EQ(Counter(node.GetStatus(), "lines"), kLines);
  EXPECT_EQ(Counter(node.GetStatus(), "lines lost"), 0);
  EXPECT_EQ(Counter(node.GetStatus(), "sweeps"), 1);
}

TEST(AssemblerNodeTest, BeforeTheRigNothingIsTaken) {
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

TEST(AssemblerNodeTest, OfALidarThatGivesWholeSweepsItIsReadyAndAssemblesNothing) {
  Rig rig = test::RigOf(simulate::Simulator(test::TinyOptions()));
  rig.lidar.turned_scanner.reset();
  AssemblerNode node;
  node.Handle(test::TextOf(ParseRig(PrintRig(rig), "whole sweeps")));
  EXPECT_TRUE(node.GetStatus().ready);
  EXPECT_THAT(node.GetStatus().text, HasSubstr("nothing to assemble"));
  EXPECT_TRUE(test::HandleAll(&node, SweepInOrder()).empty());
  node.Handle(MakeRigText());
  EXPECT_EQ(node.GetStatus().text, "waits for a sweep");
}

TEST(AssemblerNodeTest, TheRigAgainDoesNotDisturbASweepAnotherRigEndsIt) {
  AssemblerNode once;
  once.Handle(MakeRigText());
  const std::vector<Bytes> expected = BytesOf(test::HandleAll(&once, SweepInOrder()));
  Messages messages;
  for (const Message& message : SweepInOrder()) {
    messages.push_back(MakeRigText());
    messages.push_back(message);
  }
  AssemblerNode node;
  EXPECT_EQ(BytesOf(test::HandleAll(&node, messages)), expected);

  messages = SweepInOrder();
  messages.resize(messages.size() / 2);
  AssemblerNode other;
  other.Handle(MakeRigText());
  test::HandleAll(&other, messages);
  EXPECT_THAT(other.GetStatus().text, HasSubstr("assembling a sweep"));
  RigText another = MakeRigText();
  another.text += "# moved\n";
  another.hash = HashOfRigText(another.text);
  other.Handle(another);
  EXPECT_EQ(other.GetStatus().text, "waits for a sweep");
}

}  // namespace
}  // namespace rgbdt
