#include "calib/scan_assembly/assembler.h"

#include <cmath>
#include <limits>
#include <numeric>

#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr float kMiss = std::numeric_limits<float>::quiet_NaN();

LineScan LineOf(std::size_t beams, float range) {
  LineScan line;
  line.utime = 1'000'000;
  line.beam_period_s = 1e-4;
  line.first_angle_rad = -0.3;
  line.angle_step_rad = 0.01;
  line.range.assign(beams, range);
  line.intensity.assign(beams, 0.5F);
  return line;
}

TurnedScanner SkewedScanner() {
  TurnedScanner scanner;
  scanner.motor_from_scanner = RotationAbout({0.2, 1, -0.4}, 0.15);
  scanner.motor_from_scanner.translation = {0.03, -0.02, 0.11};
  scanner.ticks_per_rad = 1400 * 180 / M_PI;
  scanner.zero_ticks = 500;
  return scanner;
}

Eigen::Vector3d Turned(const Eigen::Vector3d& v, double angle) {
  return Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()) * v;
}

// The docstring's formula, written with Eigen's own rotations.
Eigen::Vector3d ByFormula(const TurnedScanner& scanner, double motor, double a, double r) {
  return Turned(scanner.motor_from_scanner * Eigen::Vector3d(r * std::cos(a), 0, r * std::sin(a)),
                motor);
}

TEST(LineToCloud, PlainScannerByHand) {
  TurnedScanner scanner;
  scanner.motor_from_scanner.translation = {0.1, 0, 0.2};
  LineScan line = LineOf(3, 2.F);
  line.first_angle_rad = 0;
  line.angle_step_rad = M_PI / 4;
  const Cloud cloud = LineToCloud(scanner, line, {0, M_PI / 2, M_PI});
  ASSERT_EQ(cloud.size(), 3U);
  const float diagonal = static_cast<float>(std::sqrt(2.0));
  // Beam 0 ahead; beam 1 up at 45 deg, turned to the left; beam 2 straight up, turned back.
  EXPECT_THAT(cloud.points[0], EigenNear(Eigen::Vector3f(2.1F, 0, 0.2F), 1e-6));
  EXPECT_THAT(cloud.points[1],
              EigenNear(Eigen::Vector3f(0, diagonal + 0.1F, diagonal + 0.2F), 1e-6));
  EXPECT_THAT(cloud.points[2], EigenNear(Eigen::Vector3f(-0.1F, 0, 2.2F), 1e-6));
}

TEST(LineToCloud, IsItsFormulaForEveryBeamWithItsOwnMotorAngle) {
  const TurnedScanner scanner = SkewedScanner();
  LineScan line = LineOf(100, 0);
  std::vector<double> angles;
  Random random(1);
  for (float& range : line.range) {
    range = static_cast<float>(random.Uniform(1, 20));
    angles.push_back(random.Uniform(-3, 3));
  }
  const Cloud cloud = LineToCloud(scanner, line, angles);
  EXPECT_EQ(cloud.lines, 1);
  EXPECT_EQ(cloud.beams, 100);
  ASSERT_EQ(cloud.origins.size(), 1U);
  for (std::size_t i = 0; i < 100; ++i) {
    const double a = -0.3 + 0.01 * static_cast<double>(i);
    const Eigen::Vector3d expected = ByFormula(scanner, angles[i], a, line.range[i]);
    EXPECT_THAT(cloud.points[i].cast<double>(), EigenNear(expected, 4e-6));  // float at 20 m
    EXPECT_NEAR(cloud.directions[i].norm(), 1, 1e-6);
    EXPECT_EQ(cloud.utime[i], 1'000'000 + 100 * static_cast<Utime>(i));
    EXPECT_EQ(cloud.ring[i], i);
    EXPECT_EQ(cloud.intensity[i], 0.5F);
  }
}

// Half of what a float can tell apart at a coordinate.
double HalfUlp(double v) {
  const auto f = static_cast<float>(std::abs(v));
  return 0.5 * static_cast<double>(std::nextafter(f, std::numeric_limits<float>::max()) - f);
}

// 100 m away, with a motor that stands, creeps, runs or jumps: but for the rounding to float, which
// is 4 um there, nothing is lost, and lines of any length are whole.
TEST(LineToCloud, IsItsFormulaToAMillionthOfAMillimetre) {
  constexpr double kTolerance = 1e-9;
  const TurnedScanner scanner = SkewedScanner();
  Random random(3);
  for (const double per_beam : {0.0, 1e-7, -1e-5, 2e-3, 0.3}) {
    for (const std::size_t beams : {1U, 15U, 16U, 17U, 401U}) {
      LineScan line = LineOf(beams, 100.F);
      std::vector<double> angles(beams, random.Uniform(-3, 3));
      for (std::size_t i = 1; i < beams; ++i) angles[i] = angles[i - 1] + per_beam;
      if (beams > 100) angles[100] += 1.5;
      const Cloud cloud = LineToCloud(scanner, line, angles);
      ASSERT_EQ(cloud.size(), beams);
      for (std::size_t i = 0; i < beams; ++i) {
        const double a = line.first_angle_rad + static_cast<double>(i) * line.angle_step_rad;
        const Eigen::Vector3d point = ByFormula(scanner, angles[i], a, 100);
        const Eigen::Vector3d direction = (point - ByFormula(scanner, angles[i], a, 0)) / 100;
        for (int k = 0; k < 3; ++k) {
          EXPECT_NEAR(cloud.points[i][k], point[k], HalfUlp(point[k]) + kTolerance)
              << per_beam << " rad a beam, beam " << i << " of " << beams;
          EXPECT_NEAR(cloud.directions[i][k], direction[k], HalfUlp(direction[k]) + kTolerance);
        }
        EXPECT_EQ(cloud.utime[i], line.utime + 100 * static_cast<Utime>(i));
        EXPECT_EQ(cloud.ring[i], i);
      }
    }
  }
}

TEST(LineToCloud, MissesKeepTheDirectionThatAHitWouldHave) {
  const TurnedScanner scanner = SkewedScanner();
  const std::vector<double> angles(10, 0.4);
  LineScan line = LineOf(10, 5.F);
  const Cloud hits = LineToCloud(scanner, line, angles);
  line.range[3] = kMiss;
  line.range[4] = std::numeric_limits<float>::infinity();
  const Cloud cloud = LineToCloud(scanner, line, angles);
  for (const std::size_t i : {3U, 4U}) {
    EXPECT_FALSE(cloud.IsHit(i));
    EXPECT_TRUE(cloud.points[i].array().isNaN().all());
    EXPECT_EQ(cloud.directions[i], hits.directions[i]);
  }
  EXPECT_TRUE(cloud.IsHit(2));
  // Origin, direction and range make the point: what a miss's direction is for.
  EXPECT_THAT(Eigen::Vector3f(cloud.origins[0] + 5 * cloud.directions[2]),
              EigenNear(hits.points[2], 2e-6));
}

TEST(LineToCloud, AnEmptyLineGivesAnEmptyCloud) {
  EXPECT_EQ(LineToCloud(SkewedScanner(), LineOf(0, 0), {}).size(), 0U);
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
        LineScan line = LineOf(beams, 1.F);
        line.utime = start;
        line.beam_period_s = period;
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
    EXPECT_EQ(sweep.points[i].x(), static_cast<float>(i / 3));
    EXPECT_EQ(sweep.intensity[i], static_cast<float>(i / 3));
    EXPECT_EQ(sweep.utime[i], static_cast<Utime>(1000 * (i / 3) + i % 3));
    EXPECT_EQ(sweep.origins[i / 3].z(), static_cast<float>(i / 3));
  }
  for (std::size_t i = 0; i < 15; ++i) EXPECT_EQ(sweep.ring[i], i % 3);
}

TEST(JoinChunks, AChunkThatCameTwiceCountsOnce) {
  const Cloud sweep = JoinChunks({ChunkOf(0, 2, 3), ChunkOf(2, 1, 3), ChunkOf(0, 2, 3)});
  EXPECT_THAT(LinesOf(sweep), ElementsAre(0, 1, 2));
}

TEST(JoinChunks, AnUnorganisedSweepIsOneLine) {
  CloudChunk first = ChunkOf(0, 1, 3);
  CloudChunk second = ChunkOf(1, 1, 5);
  first.cloud.organised = second.cloud.organised = false;
  const Cloud sweep = JoinChunks({first, second});
  EXPECT_FALSE(sweep.organised);
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

// The whole stage: a wall scanned by a turning scanner comes out flat, exactly where it stands.
TEST(ScanAssembly, AWallScannedWhileTheMotorTurnsComesOutFlat) {
  const TurnedScanner scanner = SkewedScanner();
  const Eigen::Vector3d normal = Eigen::Vector3d(1, 0.3, 0.1).normalized();
  const double wall = 4;          // normal . p = wall
  const double speed = 0.9;       // [rad/s]
  const Utime start = 1'000'000;  // the motor's angle is zero
  const auto motor_at = [&](Utime t) { return speed * ToSeconds(t - start); };

  EncoderTrack track;
  for (Utime t = start; t <= start + 500'000; t += 10'000) {
    const double ticks = motor_at(t) * scanner.ticks_per_rad + scanner.zero_ticks;
    ASSERT_TRUE(track.Add(ReadingAt(t, std::llround(ticks), start)));
  }

  std::vector<CloudChunk> chunks;
  for (int n = 0; n < 10; ++n) {
    LineScan line = LineOf(400, 0);
    line.utime = start + 40'000 * n;
    std::vector<double> angles;
    for (std::size_t i = 0; i < 400; ++i) {
      const Utime t = line.utime + 100 * static_cast<Utime>(i);
      const double a = line.first_angle_rad + static_cast<double>(i) * line.angle_step_rad;
      // Range by cutting the beam, at the true angle of its time, with the wall.
      const Eigen::Vector3d origin = ByFormula(scanner, motor_at(t), a, 0);
      const Eigen::Vector3d direction = ByFormula(scanner, motor_at(t), a, 1) - origin;
      const double range = (wall - normal.dot(origin)) / normal.dot(direction);
      line.range[i] = range > 0 && range < 20 ? static_cast<float>(range) : kMiss;
      angles.push_back(track.AngleAt(scanner, t, 20'000).value());
      // Half a tick of the encoder is all that interpolation loses at constant speed.
      ASSERT_NEAR(angles.back(), motor_at(t), 0.51 / scanner.ticks_per_rad);
    }
    CloudChunk chunk;
    chunk.cloud = LineToCloud(scanner, line, angles);
    chunk.cloud.first_line = n;
    chunks.push_back(chunk);
  }
  const Cloud sweep = JoinChunks(chunks);
  ASSERT_EQ(sweep.lines, 10);
  int hits = 0;
  for (std::size_t i = 0; i < sweep.size(); ++i) {
    if (!sweep.IsHit(i)) continue;
    ++hits;
    // Half a tick at 20 m is 0.13 mm; a motor angle per line instead of per beam would be
    // 0.9 rad/s * 40 ms * range: centimetres.
    EXPECT_NEAR(normal.dot(sweep.points[i].cast<double>()), wall,
                0.52 / scanner.ticks_per_rad * 20 + 4e-6);
  }
  EXPECT_GT(hits, 500);
  EXPECT_LT(hits, 4000);  // there are misses, too
}

}  // namespace
}  // namespace rgbdt
