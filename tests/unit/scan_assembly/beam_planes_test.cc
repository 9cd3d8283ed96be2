#include "calib/scan_assembly/internal/beam_planes.h"

#include <Eigen/Eigenvalues>
#include <numeric>

#include "calib/scan_assembly/internal/scan_patches.h"
#include "tests/unit/matchers.h"
#include "tests/unit/scan_assembly/room.h"

namespace rgbdt {
namespace {

constexpr double kSigma = 0.01;

TurnedBeams Swept(const std::vector<RoomPlane>& room) {
  Random random(1);
  RoomSweep sweep;
  sweep.sigma_m = 0;
  return SweepRoom(room, TiltedScanner().motor_from_scanner, sweep, &random);
}

std::vector<ScanPatch> PatchesOf(const PlacedBeams& beams) {
  PatchSearch search;
  search.max_turn_rad = 0.2;
  search.max_gap_m = 0.5;
  return FindPatches(beams, search).patches;
}

// Sum of squares over one plane's beams, the plane fitted anew under each geometry.
double Chi2(const TurnedBeams& swept, const BeamPlane& plane, const Vector6d& delta) {
  PlacedBeams beams({swept}, TiltedScanner(), 1000000);
  beams.Place(Exp(delta) * TiltedScanner().motor_from_scanner);
  BeamPlane fitted = plane;
  for (int i = 0; i < 3; ++i) RefitPlane(beams, kSigma, &fitted);
  return fitted.chi2;
}

// With the plane eliminated, chi2(delta) = chi2(0) - 2 gradient . delta + delta' information delta:
// the curvature by finite differences of a fit that knows nothing of derivatives by the geometry.
TEST(ScanEquations, AgreeWithTheChangeOfTheFittedPlanesChi2) {
  const TurnedBeams swept = Swept(WholeRoom());
  const PlacedBeams beams({swept}, TiltedScanner(), 1000000);
  const std::vector<ScanPatch> patches = PatchesOf(beams);
  ASSERT_GT(patches.size(), 20U);
  Vector6d delta;
  delta << 2e-3, -1e-3, 1.5e-3, 1e-3, 2e-3, -1e-3;
  for (std::size_t i = 0; i < patches.size(); i += 7) {
    ScanEquations equations;
    equations.Add(beams, patches[i].joint, kSigma, 1);
    const double predicted = delta.dot(equations.information.topLeftCorner<6, 6>() * delta);
    const double found =
        0.5 * (Chi2(swept, patches[i].joint, delta) + Chi2(swept, patches[i].joint, -delta));
    // Third and fourth orders: a turn of 2 mrad is not quite a shift.
    EXPECT_NEAR(found, predicted, 0.02 * predicted + 1e-6) << "patch " << i;
    EXPECT_LT(equations.gradient.norm(), 1e-6 * std::sqrt(equations.information.trace()));
  }
}

// The derivation in README.md, by numbers: in a room that holds all, three directions of seven are
// told by nothing, and they are the turn about z, the shift along z and the encoder's zero.
TEST(ScanEquations, AWholeRoomLeavesThreeDirections) {
  const PlacedBeams beams({Swept(WholeRoom())}, TiltedScanner(), 1000000);
  ScanEquations equations;
  for (const ScanPatch& patch : PatchesOf(beams)) equations.Add(beams, patch.joint, kSigma, 1);
  // A metre and a radian are alike here: the room is a few metres large.
  const Eigen::SelfAdjointEigenSolver<Matrix7d> solver(equations.information);
  const Vector7d& values = solver.eigenvalues();
  for (int i = 0; i < 3; ++i) EXPECT_LT(values[i], 1e-9 * values[6]);
  EXPECT_GT(values[3], 1e-3 * values[6]);
  for (int i = 0; i < 3; ++i) {
    const Vector7d v = solver.eigenvectors().col(i);
    EXPECT_NEAR(v[2] * v[2] + v[5] * v[5] + v[6] * v[6], 1, 1e-9);
  }
}

TEST(RangeNoise, IsThatOfTheRangesWhateverTheGeometry) {
  for (const double sigma : {0.003, 0.01, 0.02}) {
    Random random(2);
    RoomSweep sweep;
    sweep.sigma_m = sigma;
    const TurnedBeams swept =
        SweepRoom(WholeRoom(), TiltedScanner().motor_from_scanner, sweep, &random);
    const TurnedScanner guess =
        Moved(TiltedScanner(), (Vector6d() << 0.02, -0.02, 0, 0.01, 0.01, 0).finished());
    // The 40% point of the pieces' variances: a little below their mean.
    EXPECT_NEAR(RangeNoise(PlacedBeams({swept}, guess, 1000000)), sigma, 0.15 * sigma);
  }
}

}  // namespace
}  // namespace rgbdt
