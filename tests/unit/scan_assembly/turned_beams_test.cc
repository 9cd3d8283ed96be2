#include "calib/scan_assembly/turned_beams.h"

#include <cctype>
#include <cmath>
#include <limits>
#include <string>

#include "calib/scan_assembly/line_to_cloud.h"
#include "calib/scan_assembly/sweep_chunks.h"
#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

using testing::HasSubstr;

constexpr int kTurnedLines = 60, kBeams = 150;

struct Assembled {
  Cloud cloud;
  TurnedBeams beams;  // what it was made of
};

// A line from below the horizon over the vertical to behind, or the other way round; the motor
// turns by `turn` in all. Ranges vary, some are missing.
Assembled Assemble(const TurnedScanner& scanner, double first, double last, double turn) {
  Random random(5);
  Assembled made;
  std::vector<CloudChunk> chunks;
  for (int n = 0; n < kTurnedLines; ++n) {
    LineScan line;
    line.first_angle_rad = first;
    line.angle_step_rad = (last - first) / (kBeams - 1);
    std::vector<double> angles;
    for (int b = 0; b < kBeams; ++b) {
      const bool miss = random.Uniform(0, 1) < 0.1;
      line.range.push_back(miss ? std::numeric_limits<float>::quiet_NaN()
                                : static_cast<float>(random.Uniform(1, 8)));
      angles.push_back(0.3 + turn * (n + static_cast<double>(b) / kBeams) / kTurnedLines);
    }
    AppendLine(line, angles, &made.beams);
    CloudChunk chunk;
    chunk.cloud = LineToCloud(scanner, line, angles);
    chunk.cloud.first_line = n;
    chunks.push_back(chunk);
  }
  made.cloud = JoinChunks(chunks);
  return made;
}

TurnedScanner ScannerAt(const Vector6d& delta) {
  TurnedScanner scanner;
  scanner.motor_from_scanner = Exp(delta);
  scanner.ticks_per_rad = 1;
  return scanner;
}

double Off(double a, double b) { return std::abs(std::remainder(a - b, 2 * M_PI)); }

// Beams near the axis are left out, so both go on in step by their ranges.
void ExpectSame(const TurnedBeams& found, const TurnedBeams& expected) {
  ASSERT_GT(found.size(), expected.size() * 9 / 10);
  std::size_t e = 0;
  for (std::size_t i = 0; i < found.size(); ++i, ++e) {
    while (e < expected.size() && std::abs(expected.range_m[e] - found.range_m[i]) > 1e-5) ++e;
    ASSERT_LT(e, expected.size()) << "beam " << i << " of range " << found.range_m[i];
    // A cloud's coordinates are rounded to 2.4e-7 m at 8 m, and 0.1 m from the axis that is as many
    // tens of microradians of the motor.
    EXPECT_LT(Off(found.motor_rad[i], expected.motor_rad[e]), 5e-5);
    EXPECT_LT(Off(found.scan_rad[i], expected.scan_rad[e]), 5e-6);
  }
}

struct Case {
  const char* name;
  Vector6d delta;
  double first, last;
};

class BeamsOfCloudTest : public testing::TestWithParam<Case> {};

TEST_P(BeamsOfCloudTest, TakesApartWhatTheAssemblerMade) {
  const TurnedScanner scanner = ScannerAt(GetParam().delta);
  const Assembled made = Assemble(scanner, GetParam().first, GetParam().last, 6);
  ExpectSame(BeamsOfCloud(scanner, made.cloud), made.beams);
}

TEST_P(BeamsOfCloudTest, AlsoWithoutOrigins) {
  const TurnedScanner scanner = ScannerAt(GetParam().delta);
  Assembled made = Assemble(scanner, GetParam().first, GetParam().last, -3);
  made.cloud.origins.clear();
  ExpectSame(BeamsOfCloud(scanner, made.cloud), made.beams);
}

Vector6d D(double rx, double ry, double rz, double tx, double ty, double tz) {
  return (Vector6d() << rx, ry, rz, tx, ty, tz).finished();
}

INSTANTIATE_TEST_SUITE_P(
    Scanners, BeamsOfCloudTest,
    testing::Values(Case{"rising", D(0.01, -0.02, 0.1, 0.03, -0.01, 0.1), -0.7, 3.8},
                    Case{"falling", D(0.01, -0.02, 0.1, 0.03, -0.01, 0.1), 3.8, -0.7},
                    Case{"ahead", D(0.01, -0.02, 0.1, 0.03, -0.01, 0.1), -0.7, 0.7},
                    Case{"back", D(0.01, -0.02, 0.1, 0.03, -0.01, 0.1), 2.5, 3.9},
                    Case{"tilted", D(0.05, 0.04, -2, 0.03, -0.01, 0.1), -0.7, 3.8},
                    Case{"tilt only, falling", D(0.02, 0, 0, 0, 0, 0.1), 3.8, -0.7},
                    Case{"as drawn", D(0, 0, 0, 0, 0, 0.1), -0.7, 3.8}),
    [](const auto& info) {
      std::string name = info.param.name;
      for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
      return name;
    });

TEST(BeamsOfCloud, PointsOfMakesTheCloudAgain) {
  const TurnedScanner scanner = ScannerAt(D(0.01, -0.02, 0.1, 0.03, -0.01, 0.1));
  const Assembled made = Assemble(scanner, -0.7, 3.8, 6);
  const std::vector<Eigen::Vector3d> points = PointsOf(scanner, made.beams);
  std::size_t next = 0;
  for (std::size_t i = 0; i < made.cloud.size(); ++i) {
    if (!made.cloud.IsHit(i)) continue;
    ASSERT_LT(next, points.size());
    EXPECT_THAT(points[next++], EigenNear(made.cloud.points[i].cast<double>(), 2e-6));
  }
  EXPECT_EQ(next, points.size());
}

TEST(BeamsOfCloud, ACloudOfAnotherGeometryIsRefused) {
  const Assembled made = Assemble(ScannerAt(D(0.05, 0, 0, 0.05, 0.05, 0.1)), -0.7, 3.8, 6);
  EXPECT_THAT(InputErrorOf([&] { BeamsOfCloud(ScannerAt(D(0, 0, 0, 0, 0, 0)), made.cloud); }),
              HasSubstr("not assembled with this rig"));
}

TEST(BeamsOfCloud, ACloudWithoutOrderIsRefused) {
  const TurnedScanner scanner = ScannerAt(D(0, 0, 0, 0, 0, 0));
  Cloud cloud = Assemble(scanner, -0.7, 3.8, 6).cloud;
  cloud.organised = false;
  EXPECT_THAT(InputErrorOf([&] { BeamsOfCloud(scanner, cloud); }), HasSubstr("lines x beams"));
}

TEST(IsBehind, IsTheSideOfTheVertical) {
  const TurnedScanner scanner = ScannerAt(D(0, 0, 0, 0.3, 0, 0));
  EXPECT_FALSE(IsBehind(scanner, 1.5));
  EXPECT_TRUE(IsBehind(scanner, 1.6));
  EXPECT_FALSE(IsBehind(scanner, -1.5));
  EXPECT_TRUE(IsBehind(scanner, 3.1));
}

}  // namespace
}  // namespace rgbdt
