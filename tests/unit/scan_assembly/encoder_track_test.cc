#include "calib/scan_assembly/encoder_track.h"

#include <gtest/gtest.h>

namespace rgbdt {
namespace {

LineScan LineAt(Utime utime, std::size_t beams, double period_s) {
  LineScan line;
  line.utime = utime;
  line.beam_period_s = period_s;
  line.range.assign(beams, 1.F);
  return line;
}

EncoderReading ReadingAt(Utime utime, std::int64_t ticks, Utime sweep = 0) {
  return {utime, 0, ticks, sweep};
}

class EncoderTrackTest : public testing::Test {
 protected:
  EncoderTrackTest() {
    scanner_.ticks_per_rad = 1000;
    scanner_.zero_ticks = 200;
  }
  std::optional<double> At(Utime utime) const { return track_.AngleAt(scanner_, utime, 500); }

  TurnedScanner scanner_;
  EncoderTrack track_;
};

TEST_F(EncoderTrackTest, KnowsNothingBeforeTheFirstReading) {
  EXPECT_EQ(track_.newest(), 0);
  EXPECT_FALSE(At(100));
  EXPECT_EQ(track_.SweepAt(100), 0);
}

TEST_F(EncoderTrackTest, InterpolatesBetweenReadings) {
  track_.Add(ReadingAt(1000, 200));
  track_.Add(ReadingAt(1400, 600));
  EXPECT_EQ(track_.newest(), 1400);
  EXPECT_DOUBLE_EQ(*At(1000), 0);
  EXPECT_DOUBLE_EQ(*At(1100), 0.1);  // (300 - 200) ticks / 1000
  EXPECT_DOUBLE_EQ(*At(1399), 0.399);
  EXPECT_DOUBLE_EQ(*At(1400), 0.4);
}

TEST_F(EncoderTrackTest, NegativeTicksPerRadTurnTheOtherWay) {
  scanner_.ticks_per_rad = -1000;
  track_.Add(ReadingAt(1000, 200));
  track_.Add(ReadingAt(1400, 600));
  EXPECT_DOUBLE_EQ(*At(1100), -0.1);
}

TEST_F(EncoderTrackTest, DoesNotExtrapolate) {
  track_.Add(ReadingAt(1000, 200));
  track_.Add(ReadingAt(1400, 600));
  EXPECT_FALSE(At(999));
  EXPECT_FALSE(At(1401));
}

TEST_F(EncoderTrackTest, AGapHasNoAngleButItsEndsHave) {
  track_.Add(ReadingAt(1000, 200));
  track_.Add(ReadingAt(1500, 700));   // exactly the longest gap allowed
  track_.Add(ReadingAt(2001, 1200));  // one microsecond too long
  EXPECT_TRUE(At(1250));
  EXPECT_TRUE(At(1500));
  EXPECT_FALSE(At(1501));
  EXPECT_FALSE(At(2000));
  EXPECT_DOUBLE_EQ(*At(2001), 1.0);
}

TEST_F(EncoderTrackTest, RefusesReadingsThatDoNotCome) {
  EXPECT_TRUE(track_.Add(ReadingAt(1000, 200)));
  EXPECT_TRUE(track_.Add(ReadingAt(1400, 600)));
  EXPECT_FALSE(track_.Add(ReadingAt(1400, 9999)));
  EXPECT_FALSE(track_.Add(ReadingAt(1200, 9999)));
  EXPECT_DOUBLE_EQ(*At(1200), 0.2);  // as if they had never come
  EXPECT_EQ(track_.newest(), 1400);
}

TEST_F(EncoderTrackTest, ATimeBelongsToTheSweepOfTheReadingBeforeIt) {
  track_.Add(ReadingAt(1000, 0, 0));
  track_.Add(ReadingAt(2000, 0, 1900));
  track_.Add(ReadingAt(3000, 0, 0));
  EXPECT_EQ(track_.SweepAt(999), 0);
  EXPECT_EQ(track_.SweepAt(1999), 0);
  EXPECT_EQ(track_.SweepAt(2000), 1900);
  EXPECT_EQ(track_.SweepAt(2999), 1900);
  EXPECT_EQ(track_.SweepAt(3000), 0);
  EXPECT_EQ(track_.SweepAt(9000), 0);
}

TEST_F(EncoderTrackTest, ForgettingKeepsWhatLaterTimesNeed) {
  for (Utime t = 1000; t <= 2000; t += 100) track_.Add(ReadingAt(t, t, t));
  const double angle = *At(1550);
  track_.ForgetBefore(1550);
  EXPECT_FALSE(At(1499));
  EXPECT_EQ(track_.SweepAt(1499), 0);
  EXPECT_DOUBLE_EQ(*At(1550), angle);
  EXPECT_EQ(track_.SweepAt(1550), 1500);
  track_.ForgetBefore(9999);  // the newest stays: the next reading interpolates from it
  EXPECT_EQ(track_.newest(), 2000);
  EXPECT_TRUE(At(2000));
}

// Each beam's angle is the one that its time has by itself, across readings and their gaps.
TEST_F(EncoderTrackTest, ALinesAnglesAreThoseOfItsBeamsTimes) {
  for (const Utime t : {1'000'000, 1'000'350, 1'000'400, 1'001'000, 1'003'000, 1'003'700}) {
    ASSERT_TRUE(track_.Add(ReadingAt(t, t % 977)));
  }
  for (const Utime start : {1'000'000, 1'000'299, 1'000'350, 1'003'001}) {
    for (const std::size_t beams : {0U, 1U, 2U, 7U, 8U, 40U}) {
      for (const double period : {1e-4, 3.3e-5, 1e-7, -1e-4}) {
        const LineScan line = LineAt(start, beams, period);
        const auto angles = BeamAngles(scanner_, track_, line, 1000);
        std::vector<double> expected;
        for (std::size_t i = 0; i < beams; ++i) {
          const double after = static_cast<double>(i) * period;
          const auto angle = track_.AngleAt(scanner_, start + FromSeconds(after), 1000);
          if (!angle) break;
          expected.push_back(*angle);
        }
        ASSERT_EQ(angles.has_value(), expected.size() == beams);
        if (angles) {
          EXPECT_EQ(*angles, expected);
        }
      }
    }
  }
}

}  // namespace
}  // namespace rgbdt
