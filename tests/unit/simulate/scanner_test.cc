#include "calib/simulate/internal/scanner.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/simulate/simulate_testing.h"

namespace rgbdt::simulate {
namespace {

using Eigen::Vector3d;

/// A wall across x, from y `from` to y `to`.
Mesh Wall(double x, double from = -50, double to = 50) {
  return MakeQuad({x, from, -50}, {x, to, -50}, {x, to, 50}, {x, from, 50});
}

/// A scanner in the LIDAR's origin whose beam 0 is level.
ScannerOptions LevelScanner() {
  ScannerOptions options;
  options.lever_arm_m.setZero();
  options.tilt_rad.setZero();
  options.first_angle_rad = 0;
  options.beams = 10;
  return options;
}

TEST(CombineReturns, MergesWhatIsCloseByEnergy) {
  std::vector<SubReturn> returns(10, {4.0, 0.7});
  returns.insert(returns.end(), 9, {4.3, 0.1});
  const BeamReturn back = CombineReturns({}, 19, &returns);
  const double near = 10 * 0.7 / 16;
  const double far = 9 * 0.1 / (4.3 * 4.3);
  EXPECT_NEAR(back.range, (near * 4.0 + far * 4.3) / (near + far), 1e-12);
  EXPECT_NEAR(back.intensity, (near + far) / 19 * back.range * back.range, 1e-12);
}

TEST(CombineReturns, ReportsTheStrongerOfTwoThatAreApart) {
  // Fewer sub-rays, but nearer and brighter.
  std::vector<SubReturn> returns(7, {3.0, 0.7});
  returns.insert(returns.end(), 12, {6.0, 0.5});
  EXPECT_DOUBLE_EQ(CombineReturns({}, 19, &returns).range, 3.0);
  returns.assign(7, {3.0, 0.05});
  returns.insert(returns.end(), 12, {6.0, 0.7});
  EXPECT_DOUBLE_EQ(CombineReturns({}, 19, &returns).range, 6.0);
}

TEST(CombineReturns, DropsWhatIsBelowTwoPercentOfAWhiteWall) {
  std::vector<SubReturn> returns(4, {5.0, 0.08});  // 4/19 * 0.08 = 1.7%
  EXPECT_TRUE(std::isnan(CombineReturns({}, 19, &returns).range));
  returns.assign(5, {5.0, 0.08});  // 2.1%
  EXPECT_DOUBLE_EQ(CombineReturns({}, 19, &returns).range, 5.0);
  returns.clear();
  EXPECT_TRUE(std::isnan(CombineReturns({}, 19, &returns).range));
}

TEST(CombineReturns, MergesNothingWhenToldSo) {
  ScannerOptions options;
  options.merge_m = 0;
  std::vector<SubReturn> returns{{4, 0.5}, {4.1, 0.6}};
  EXPECT_DOUBLE_EQ(CombineReturns(options, 2, &returns).range, 4.1);
}

TEST(Scanner, HasThePapersSweep) {
  const Scanner scanner({}, 1);
  EXPECT_EQ(scanner.sweep_lines(), 300);
  EXPECT_EQ(scanner.line_period(), 40000);
  EXPECT_NEAR(scanner.MotorAngle(0), -30 * kDegree, 1e-12);
  EXPECT_NEAR(scanner.MotorAngle(6), 0, 1e-12);
  EXPECT_NEAR(scanner.MotorAngle(12), 30 * kDegree, 1e-12);
  EXPECT_NEAR(scanner.MotorAngle(99), 30 * kDegree, 1e-12);
  EXPECT_EQ(scanner.Ticks(1 * kDegree) - scanner.Ticks(0), 1400);
}

TEST(Scanner, BeamsMeetAWallWhereGeometrySays) {
  Options options;
  options.scanner.range_sigma_m = 1e-9;
  const Scanner scanner(options.scanner, 1);
  const World world = SheetWorld({Wall(5)}, 0.5, options);
  const Rigid3& motor_from_scanner = scanner.geometry().motor_from_scanner;
  for (const int line : {0, 77, 150, 299}) {
    const LineScan scan = scanner.Line(world, 1000000, line);
    EXPECT_EQ(scan.utime, 1000000 + line * 40000);
    for (int beam = 0; beam < 400; beam += 13) {
      // The motor goes on turning while the line is fired.
      const double motor = -30 * kDegree + 5 * kDegree * (line * 0.04 + beam * 1e-4);
      const double a = scan.first_angle_rad + beam * scan.angle_step_rad;
      const Rigid3 lidar_from_scanner =
          RotationAbout(Vector3d::UnitZ(), motor) * motor_from_scanner;
      const Vector3d direction =
          lidar_from_scanner.rotation * Vector3d(std::cos(a), 0, std::sin(a));
      const double expected = (5 - lidar_from_scanner.translation.x()) / direction.x();
      // The beam's width shifts a slanted return by some 10 um.
      EXPECT_NEAR(scan.range[static_cast<std::size_t>(beam)], expected, 5e-5);
      EXPECT_NEAR(scan.intensity[static_cast<std::size_t>(beam)], 0.5, 0.06);
    }
  }
}

TEST(Scanner, RangeNoiseHasItsSigma) {
  const Options options;
  const Scanner scanner(options.scanner, 3);
  Options quiet = options;
  quiet.scanner.range_sigma_m = 1e-9;
  const Scanner truth(quiet.scanner, 3);
  const World world = SheetWorld({Wall(5)}, 0.5, options);
  double sum = 0, squares = 0;
  int count = 0;
  for (int line = 0; line < 300; line += 12) {
    const LineScan a = scanner.Line(world, 0, line);
    const LineScan b = truth.Line(world, 0, line);
    for (std::size_t i = 0; i < a.range.size(); ++i) {
      const double error = a.range[i] - b.range[i];
      sum += error;
      squares += error * error;
      ++count;
    }
  }
  EXPECT_NEAR(sum / count, 0, 3e-4);
  EXPECT_NEAR(std::sqrt(squares / count), 0.010, 3e-4);
}

TEST(Scanner, BeamAcrossAStepMergesOrTakesTheStronger) {
  Options options;
  options.scanner = LevelScanner();
  const Scanner scanner(options.scanner, 1);
  // At motor angle zero half of beam 0 meets each side.
  const BeamReturn merged =
      scanner.Beam(SheetWorld({Wall(5, -50, 0), Wall(5.4, 0, 50)}, 0.5, options), 0, 1e-5);
  EXPECT_GT(merged.range, 5.1);
  EXPECT_LT(merged.range, 5.3);
  const BeamReturn nearer =
      scanner.Beam(SheetWorld({Wall(5, -50, 0), Wall(6, 0, 50)}, 0.5, options), 0, 1e-5);
  EXPECT_NEAR(nearer.range, 5, 1e-5);
}

TEST(Scanner, SeesHalfADivergencePastAnEdge) {
  Options options;
  options.scanner = LevelScanner();
  const Scanner scanner(options.scanner, 1);
  const World world = SheetWorld({Wall(5, -50, 0)}, 0.7, options);
  // Nothing behind: the beam returns as long as some of it meets the wall, within 1.35 mrad.
  EXPECT_FALSE(std::isnan(scanner.Beam(world, 0, 0.9e-3).range));
  EXPECT_TRUE(std::isnan(scanner.Beam(world, 0, 1.4e-3).range));
  EXPECT_TRUE(std::isnan(scanner.Line(world, 0, scanner.sweep_lines() - 1).range[0]));
  EXPECT_EQ(scanner.Line(world, 0, scanner.sweep_lines() - 1).intensity[0], 0);
}

}  // namespace
}  // namespace rgbdt::simulate
