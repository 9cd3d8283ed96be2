#include "calib/scan_assembly/scanner_geometry.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "tests/numbers.h"
#include "tests/study/scanner_scenes.h"
#include "tests/unit/matchers.h"
#include "tests/unit/scan_assembly/room.h"

namespace rgbdt {
namespace {

using study::ObservableCovariance;
using study::ScannerErrorOf;
using testing::HasSubstr;

enum Direction { kRx, kRy, kRz, kTx, kTy, kTz, kZero };

Vector6d Delta(double deg, double m) {
  return (Vector6d() << deg, -deg, deg, 0, 0, 0).finished() * kDegree +
         (Vector6d() << 0, 0, 0, m, m, -m).finished();
}

// The room, swept by the true scanner and judged from a guess that is `off`.
ScannerGeometry Find(const std::vector<RoomPlane>& room, const RoomSweep& sweep,
                     const Vector6d& off, std::uint32_t seed = 1) {
  Random random(seed);
  const TurnedBeams beams = SweepRoom(room, TiltedScanner().motor_from_scanner, sweep, &random);
  return FindScannerGeometry(Moved(TiltedScanner(), off), {beams});
}

Eigen::Vector4d ErrorOf(const ScannerGeometry& found) {
  return ScannerErrorOf(TiltedScanner().motor_from_scanner, found.scanner.motor_from_scanner);
}

// Enough beams to tell 0.02 degrees and half a millimetre by.
RoomSweep FineSweep() {
  RoomSweep sweep;
  sweep.lines *= 2;
  sweep.beams *= 2;
  sweep.sigma_m = 0.005;
  return sweep;
}

void ExpectFound(const ScannerGeometry& found, double deg, double m) {
  ASSERT_TRUE(found.converged) << found.BriefReport();
  const Eigen::Vector4d error = ErrorOf(found);
  EXPECT_LT(error.head<2>().cwiseAbs().maxCoeff(), deg * kDegree) << found.BriefReport();
  EXPECT_LT(error.tail<2>().cwiseAbs().maxCoeff(), m) << found.BriefReport();
}

TEST(ScannerGeometry, WithoutNoiseTheTruthIsFound) {
  RoomSweep sweep;
  sweep.sigma_m = 0;
  // What double precision and two steps of the last stages leave.
  ExpectFound(Find(WholeRoom(), sweep, Delta(0.5, 0.005)), 1e-4, 1e-6);
}

// The paper assumes these errors away. Half a millimetre and 0.02 degrees are asked for.
TEST(ScannerGeometry, FiveMillimetresAndHalfADegreeAreFound) {
  const ScannerGeometry found = Find(WholeRoom(), FineSweep(), Delta(0.5, 0.005));
  ExpectFound(found, 0.02, 0.0005);
  EXPECT_NEAR(found.range_sigma_m, 0.005, 0.0002);
  EXPECT_GT(found.gap_before_m, 0.02);
  EXPECT_LT(found.gap_after_m, 0.1 * found.gap_before_m);
}

TEST(ScannerGeometry, TwentyMillimetresAndTwoDegreesAreFoundAsWell) {
  ExpectFound(Find(WholeRoom(), FineSweep(), Delta(2, 0.02)), 0.02, 0.0005);
  ExpectFound(Find(WholeRoom(), FineSweep(), Delta(-2, -0.02)), 0.02, 0.0005);
}

// Another room, by rays: edges, furniture, a person, wide beams, an encoder of whole ticks, a cloud
// that is taken apart.
TEST(ScannerGeometry, TheSyntheticRigsIsFound) {
  const study::ScannerCase made =
      study::MakeScannerCase(7, study::ScannerError(), simulate::FullTurnScanner());
  const ScannerGeometry found = FindScannerGeometry(made.guess, {made.beams});
  ASSERT_TRUE(found.converged) << found.BriefReport();
  const Eigen::Vector4d error =
      ScannerErrorOf(made.truth.motor_from_scanner, found.scanner.motor_from_scanner);
  EXPECT_LT(error.head<2>().cwiseAbs().maxCoeff(), 0.02 * kDegree);
  EXPECT_LT(error.tail<2>().cwiseAbs().maxCoeff(), 0.0005);
}

// Sum of 25 chi-squares of 4: 100 +- 14.1, here within three sigmas.
TEST(ScannerGeometry, TheCovarianceIsThatOfTheErrors) {
  double nees = 0;
  for (std::uint32_t seed = 1; seed <= 25; ++seed) {
    const ScannerGeometry found = Find(WholeRoom(), RoomSweep(), Delta(0.3, 0.004), seed);
    ASSERT_TRUE(found.converged);
    const Eigen::Vector4d error = ErrorOf(found);
    nees += error.dot(ObservableCovariance(found).llt().solve(error));
  }
  EXPECT_GT(nees, 100 - 3 * 14.1);
  EXPECT_LT(nees, 100 + 3 * 14.1);
}

// Three of the seven are seen by no sweep: from a guess that errs in nothing else it does not move,
// and the report says why.
class Gauge : public testing::TestWithParam<int> {};

TEST_P(Gauge, IsNotObservedAndStaysAsGuessed) {
  Vector6d off = Vector6d::Zero();
  if (GetParam() < 6) off[GetParam()] = GetParam() < 3 ? 0.01 : 0.02;
  const ScannerGeometry found = Find(WholeRoom(), RoomSweep(), off);
  ASSERT_TRUE(found.converged);
  const ScannerDirection& direction = found.directions[static_cast<std::size_t>(GetParam())];
  EXPECT_FALSE(direction.observed);
  EXPECT_THAT(direction.why, HasSubstr("whole cloud"));
  const double prior = direction.is_angle ? ScannerGeometryOptions().tilt_prior_rad
                                          : ScannerGeometryOptions().lever_prior_m;
  EXPECT_NEAR(direction.sigma, prior, 1e-9);
  EXPECT_EQ(found.scanner.zero_ticks, TiltedScanner().zero_ticks);
  const Rigid3 guess = Moved(TiltedScanner(), off).motor_from_scanner;
  const Vector6d moved = Log(found.scanner.motor_from_scanner * guess.Inverse());
  for (const int i : {kRz, kTz}) EXPECT_NEAR(moved[i], 0, 1e-5);
  // Nor does an error there spoil the others, or show as a gap.
  EXPECT_LT(moved.norm(), 0.002);
  EXPECT_NEAR(found.gap_before_m, found.gap_after_m, 0.0005);
}

INSTANTIATE_TEST_SUITE_P(ScannerGeometry, Gauge, testing::Values(kRz, kTz, kZero));

// The other four each open a gap, and are found alone.
class Observable : public testing::TestWithParam<int> {};

TEST_P(Observable, OpensAGapAndIsFound) {
  Vector6d off = Vector6d::Zero();
  off[GetParam()] = GetParam() < 3 ? 1 * kDegree : 0.01;
  const ScannerGeometry found = Find(WholeRoom(), FineSweep(), off);
  ASSERT_TRUE(found.converged) << found.BriefReport();
  EXPECT_GT(found.gap_before_m, 2 * found.gap_after_m);
  const ScannerDirection& direction = found.directions[static_cast<std::size_t>(GetParam())];
  EXPECT_TRUE(direction.observed);
  EXPECT_EQ(direction.why, "");
  EXPECT_NEAR(direction.change, -off[GetParam()], 5 * direction.sigma);
}

INSTANTIATE_TEST_SUITE_P(ScannerGeometry, Observable, testing::Values(kRx, kRy, kTx, kTy));

// A floor and a ceiling slide in themselves: only what lifts them is seen.
TEST(ScannerGeometry, AFloorAndACeilingTellOneTiltOnly) {
  const ScannerGeometry found = Find(FloorAndCeiling(), RoomSweep(), Delta(0.3, 0.003));
  ASSERT_TRUE(found.converged) << found.BriefReport();
  EXPECT_TRUE(found.directions[kRy].observed);
  for (const int i : {kRx, kTx, kTy}) {
    const ScannerDirection& direction = found.directions[static_cast<std::size_t>(i)];
    EXPECT_FALSE(direction.observed) << direction.name;
    EXPECT_THAT(direction.why, HasSubstr("wall"));
  }
  EXPECT_THAT(found.BriefReport(), HasSubstr("lever arm x     not observed by this sweep"));
  EXPECT_NEAR(ErrorOf(found)[1], 0, 5 * found.directions[kRy].sigma);
}

// Beams that all look ahead see nothing twice, however far the motor turns.
TEST(ScannerGeometry, ALineThatLooksAheadOnlyTellsNothing) {
  RoomSweep sweep;
  sweep.last_scan_rad = 0.8;
  const Vector6d off = Delta(0.5, 0.005);
  const ScannerGeometry found = Find(WholeRoom(), sweep, off);
  EXPECT_FALSE(found.converged);
  EXPECT_EQ(found.seen_twice, 0);
  EXPECT_THAT(found.detail, HasSubstr("both halves"));
  for (const ScannerDirection& direction : found.directions) EXPECT_FALSE(direction.observed);
  EXPECT_THAT(found.directions[kTx].why, HasSubstr("over the vertical"));
  const Rigid3 guess = Moved(TiltedScanner(), off).motor_from_scanner;
  EXPECT_THAT(found.scanner.motor_from_scanner, Rigid3Near(guess, 0, 0));
}

// Turned by 270 of 360 degrees, half of the room is seen twice: enough, and less sure.
TEST(ScannerGeometry, AShorterTurnIsLessSure) {
  RoomSweep sweep = FineSweep();
  const ScannerGeometry whole = Find(WholeRoom(), sweep, Delta(0.3, 0.003));
  sweep.turn_rad *= 0.75;
  sweep.lines = sweep.lines * 3 / 4;
  const ScannerGeometry shorter = Find(WholeRoom(), sweep, Delta(0.3, 0.003));
  ExpectFound(shorter, 0.02, 0.0005);
  EXPECT_LT(shorter.seen_twice, whole.seen_twice);
  for (const int i : {kRx, kRy, kTx, kTy}) {
    EXPECT_GT(shorter.directions[static_cast<std::size_t>(i)].sigma,
              whole.directions[static_cast<std::size_t>(i)].sigma);
  }
}

// What moved between the two passes: a wall that one half sees 0.1 m nearer.
TEST(ScannerGeometry, WhatMovedIsLeftOut) {
  Random random(3);
  TurnedBeams beams =
      SweepRoom(WholeRoom(), TiltedScanner().motor_from_scanner, FineSweep(), &random);
  const std::vector<Eigen::Vector3d> points = PointsOf(TiltedScanner(), beams);
  int moved = 0;
  for (std::size_t i = 0; i < beams.size(); ++i) {
    const double azimuth = std::atan2(points[i].y(), points[i].x());
    if (!IsBehind(TiltedScanner(), beams.scan_rad[i]) || std::abs(azimuth - 1) > 0.4) continue;
    beams.range_m[i] -= 0.1;
    ++moved;
  }
  ASSERT_GT(moved, 500);
  const ScannerGeometry found =
      FindScannerGeometry(Moved(TiltedScanner(), Delta(0.5, 0.005)), {beams});
  ExpectFound(found, 0.02, 0.0005);
}

TEST(ScannerGeometry, TheNoiseIsFoundWhateverTheRigFileSays) {
  RoomSweep sweep = FineSweep();
  sweep.sigma_m = 0.025;
  const ScannerGeometry found = Find(WholeRoom(), sweep, Delta(0.5, 0.005));
  EXPECT_NEAR(found.range_sigma_m, 0.025, 0.001);
  const Eigen::Vector4d error = ErrorOf(found);
  // 25 mm of noise: within five sigmas, and these are small.
  EXPECT_LT(error.dot(ObservableCovariance(found).llt().solve(error)), 25);
  EXPECT_LT(found.directions[kRx].sigma, 0.05 * kDegree);
}

TEST(ScannerGeometry, TheSameInputGivesTheSameBits) {
  const ScannerGeometry a = Find(WholeRoom(), RoomSweep(), Delta(0.5, 0.005));
  const ScannerGeometry b = Find(WholeRoom(), RoomSweep(), Delta(0.5, 0.005));
  EXPECT_THAT(a.scanner.motor_from_scanner, Rigid3Near(b.scanner.motor_from_scanner, 0, 0));
  EXPECT_TRUE((a.covariance.array() == b.covariance.array()).all());
}

TEST(ScannerGeometry, BadInputIsNamed) {
  EXPECT_THAT(InputErrorOf([] { FindScannerGeometry(TiltedScanner(), {TurnedBeams()}); }),
              HasSubstr("none of the sweeps"));
  Random random(1);
  const TurnedBeams beams =
      SweepRoom(WholeRoom(), TiltedScanner().motor_from_scanner, RoomSweep(), &random);
  ScannerGeometryOptions options;
  options.lever_prior_m = -1;
  EXPECT_THAT(InputErrorOf([&] { FindScannerGeometry(TiltedScanner(), {beams}, options); }),
              HasSubstr("lever_prior_m is -1"));
}

}  // namespace
}  // namespace rgbdt
