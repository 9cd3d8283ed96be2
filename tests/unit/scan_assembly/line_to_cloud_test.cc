#include "calib/scan_assembly/line_to_cloud.h"

#include <cmath>
#include <limits>
#include <numeric>

#include "calib/scan_assembly/encoder_track.h"
#include "calib/scan_assembly/sweep_chunks.h"
#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

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
    ASSERT_TRUE(track.Add({t, 0, std::llround(ticks), start}));
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
