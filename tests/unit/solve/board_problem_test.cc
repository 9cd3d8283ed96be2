#include "calib/solve/board_problem.h"

#include <list>

#include "tests/numbers.h"
#include "tests/unit/solve/solve_world.h"

namespace rgbdt {
namespace {

const Target kTarget{9, 6, 0.1, 1.0, 0.7, {0, 0}, {}};

Eigen::Vector3d OutwardOf(int side) {
  const Eigen::Vector3d outward[] = {{0, -1, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}};
  return outward[side];
}

// A board 3 m ahead, tilted so that its sides are seen at slants of either sign.
Rigid3 TiltedBoard(double about_x, double about_y) {
  Eigen::Matrix3d facing;  // target x right, y down, z away, seen along the LIDAR's x
  facing << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  Rigid3 board = Rigid3{Eigen::Quaterniond(facing), {0, 0, 0}} * RotationAbout({1, 0, 0}, about_x) *
                 RotationAbout({0, 1, 0}, about_y) * RotationAbout({0, 0, 1}, 0.3);
  board.translation = {3, 0.4, -0.3};
  return board;
}

// A crossing on the board's plane, `beyond` metres outwards of the middle of its side.
Crossing CrossingOn(const Rigid3& board, int side, double beyond) {
  Crossing crossing;
  crossing.side = side;
  crossing.kind = CrossingKind::kFar;
  crossing.half_width_m = 0.005;
  crossing.sigma_m = 0.003;
  const double half = side % 2 == 1 ? kTarget.width_m / 2 : kTarget.height_m / 2;
  const Eigen::Vector3d along(OutwardOf(side).y(), OutwardOf(side).x(), 0);
  crossing.point = board * Eigen::Vector3d((half + beyond) * OutwardOf(side) + 0.17 * along);
  return crossing;
}

CrossingResidual ResidualAt(const Crossing& crossing, const Rigid3& board,
                            const std::array<double, kSharedUnknowns>& shared = {}) {
  return ResidualOf(kTarget, {}, crossing, board, shared, 0);
}

class ResidualOfSide : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Sides, ResidualOfSide, testing::Range(0, 4));

TEST_P(ResidualOfSide, IsTheDistanceBeyondTheSide) {
  const Rigid3 board = TiltedBoard(0.5, -0.4);
  EXPECT_NEAR(ResidualAt(CrossingOn(board, GetParam(), 0.012), board).beyond_m, 0.012, 1e-12);
  EXPECT_NEAR(ResidualAt(CrossingOn(board, GetParam(), -0.02), board).beyond_m, -0.02, 1e-12);
}

TEST_P(ResidualOfSide, ByTargetIsItsDerivative) {
  std::array<double, kSharedUnknowns> shared{};
  shared[kFarShift] = 2e-3;
  shared[kThickness] = 0.02;
  shared[kFringe] = 0.03;
  for (const double tilt : {-0.5, 0.5}) {  // the rim hidden, and seen
    const Rigid3 board = TiltedBoard(tilt, 0.8 * tilt);
    const Crossing crossing = CrossingOn(board, GetParam(), 0.012);
    const CrossingResidual r = ResidualAt(crossing, board, shared);
    constexpr double kStep = 1e-5;
    for (int i = 0; i < 6; ++i) {
      const Vector6d delta = kStep * Vector6d::Unit(i);
      const double slope = (ResidualAt(crossing, board * Exp(delta), shared).beyond_m -
                            ResidualAt(crossing, board * Exp(-delta), shared).beyond_m) /
                           (2 * kStep);
      EXPECT_NEAR(r.by_target[i], slope, 1e-8) << "delta " << i;
    }
  }
}

TEST_P(ResidualOfSide, ABeamBentOutwardsMeetsTheBoardFartherOut) {
  const Rigid3 board = TiltedBoard(0.5, -0.4);
  constexpr double kAngle = 1e-4;
  Crossing crossing = CrossingOn(board, GetParam(), 0);
  const Eigen::Vector3d outward = board.rotation * OutwardOf(GetParam());
  crossing.point = RotationAbout(crossing.point.cross(outward), kAngle) * crossing.point;
  EXPECT_NEAR(ResidualAt(crossing, board).beyond_m, kAngle * ResidualAt(crossing, board).per_rad,
              1e-7);
  std::array<double, kSharedUnknowns> shared{};
  shared[kFarShift] = kAngle;
  EXPECT_NEAR(ResidualAt(crossing, board, shared).beyond_m, 0, 1e-7);
}

TEST_P(ResidualOfSide, AFringeIsALengthAtAnyRange) {
  std::array<double, kSharedUnknowns> shared{};
  shared[kFringe] = 0.03;
  for (const double away : {1.0, 2.0}) {
    Rigid3 board = TiltedBoard(0.5, -0.4);
    board.translation *= away;
    const CrossingResidual r = ResidualAt(CrossingOn(board, GetParam(), 0.03), board, shared);
    EXPECT_NEAR(r.beyond_m, 0.03 - 0.03 * r.per_fringe, 1e-12);
  }
}

TEST_P(ResidualOfSide, ARimThatFacesTheLidarIsSeenBesideTheFrontAnyOtherIsHidden) {
  constexpr double kThick = 0.02;
  int facing = 0;
  for (const double tilt : {-0.7, 0.7}) {
    const Rigid3 board = GetParam() % 2 == 0 ? TiltedBoard(tilt, 0) : TiltedBoard(0, tilt);
    const Crossing front = CrossingOn(board, GetParam(), 0);
    // The rim's far edge: its beam meets the front's plane outside of the side, or inside.
    Crossing rim = front;
    rim.point =
        board * Eigen::Vector3d(board.Inverse() * front.point + kThick * Eigen::Vector3d::UnitZ());
    const double seen = std::max(0.0, ResidualAt(rim, board).beyond_m);
    EXPECT_NEAR(kThick * ResidualAt(rim, board).per_thickness, seen, 1e-9) << tilt;
    std::array<double, kSharedUnknowns> shared{};
    shared[kThickness] = kThick;
    EXPECT_NEAR(ResidualAt(seen > 0 ? rim : front, board, shared).beyond_m, 0, 1e-9) << tilt;
    facing += seen > 0.001 ? 1 : 0;
  }
  EXPECT_EQ(facing, 1);
}

TEST_P(ResidualOfSide, TheSidesOwnCutAndShiftAreTakenOff) {
  const Rigid3 board = TiltedBoard(0.5, -0.4);
  const Crossing crossing = CrossingOn(board, GetParam(), 0.004);
  std::array<double, kSharedUnknowns> shared{};
  shared[static_cast<std::size_t>(kOutlineTop + GetParam())] = 0.003;
  shared[static_cast<std::size_t>(kOutlineTop + (GetParam() + 1) % 4)] = 0.1;  // another's
  shared[kMergedShift] = 0.1;                                                  // another class
  EXPECT_NEAR(ResidualAt(crossing, board, shared).beyond_m, 0.001, 1e-12);
  const CrossingResidual r = ResidualOf(kTarget, {}, crossing, board, {}, 1e-3);
  EXPECT_NEAR(r.beyond_m, 0.004 - 1e-3 * r.per_rad, 1e-12);
}

// Beams tell directions: a board that is smaller and nearer alike, under the same beams, fits as
// well, and is drawn no nearer.
TEST_P(ResidualOfSide, ASmallerAndNearerBoardIsNoBetter) {
  const Rigid3 board = TiltedBoard(0.5, -0.4);
  const Crossing crossing = CrossingOn(board, GetParam(), 0.012);
  std::array<double, kSharedUnknowns> shared{};
  shared[kFarShift] = 2e-3;
  const CrossingResidual r = ResidualAt(crossing, board, shared);
  for (const double smaller : {0.9, 0.99, 1.1}) {
    Target target = kTarget;
    target.width_m *= smaller;
    target.height_m *= smaller;
    Rigid3 nearer = board;
    nearer.translation *= smaller;
    const CrossingResidual same = ResidualOf(target, {}, crossing, nearer, shared, 0);
    EXPECT_NEAR(same.beyond_m, r.beyond_m, 1e-12) << smaller;
    EXPECT_NEAR(same.sigma_m, r.sigma_m, 0.001 * r.sigma_m) << smaller;
  }
}

TEST(ResidualOf, OfABeamThatMissesTheFrontThereIsNone) {
  const Rigid3 board = TiltedBoard(0, 0);
  Crossing crossing = CrossingOn(board, 0, 0);
  crossing.point = -crossing.point;
  EXPECT_EQ(ResidualAt(crossing, board).per_rad, 0);
}

// SolveBoards.

SolveWorldOptions Exact() {
  SolveWorldOptions options;
  options.noise = 0;
  options.views = 8;
  return options;
}

BoardSolution Solve(const JointProblem& joint) { return SolveBoards(joint.problem, joint.start); }

// The guess some degrees and centimetres off, the boards too.
BoardState StartOff(JointProblem joint) {
  Random random(5);
  for (Rigid3& pose : joint.start.camera_from_lidar) {
    pose = RotationAbout(random.Direction(), 4 * kDegree) * pose;
    pose.translation += 0.05 * random.Direction();
  }
  for (Rigid3& board : joint.start.lidar_from_target) {
    board = board * RotationAbout(random.Direction(), 2 * kDegree);
    board.translation += 0.02 * random.Direction();
  }
  return joint.start;
}

TEST(SolveBoards, RecoversAPinholeAndAFisheyeExactlyFromDegreesOff) {
  const SolveWorld world(Exact());
  const SolveSession session(world);
  const JointProblem joint = session.Joint();
  const BoardSolution solution = SolveBoards(joint.problem, StartOff(joint));
  EXPECT_TRUE(solution.converged);
  EXPECT_LT(solution.iterations, 30);
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_THAT(solution.state.camera_from_lidar[c],
                Rigid3Near(world.camera_from_lidar[c], 1e-6, 1e-6));
  }
  for (std::size_t v = 0; v < world.lidar_from_target.size(); ++v) {
    EXPECT_THAT(solution.state.lidar_from_target[v],
                Rigid3Near(world.lidar_from_target[v], 1e-6, 1e-6));
  }
}

TEST(SolveBoards, FindsWhatTheBeamsWidthTheRimAndTheCutDo) {
  SolveWorldOptions options = Exact();
  options.views = 14;
  options.shared = {1.2e-3, -0.8e-3, 2.0e-3, 0.022, 1.5e-3, -1.0e-3, 0.5e-3, 2e-3, 0};
  const SolveWorld world(options);
  const SolveSession session(world);
  JointProblem joint = session.Joint();
  joint.problem.priors.class_sigma_rad = 1;  // the data alone
  joint.problem.priors.thickness_sigma_m = 1;
  joint.problem.priors.outline_sigma_m = 1;
  joint.problem.priors.side_sigma_rad = 1e-6;
  const BoardSolution solution = SolveBoards(joint.problem, StartOff(joint));
  ASSERT_TRUE(solution.converged);
  for (std::size_t k = 0; k < kRangeOffset; ++k) {
    EXPECT_NEAR(solution.state.shared[k], options.shared[k], 2e-5) << "unknown " << k;
  }
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_THAT(solution.state.camera_from_lidar[c],
                Rigid3Near(world.camera_from_lidar[c], 2e-5, 2e-5));
  }
}

TEST(SolveBoards, FindsWhatTheRangesAreOffByWhereItMayLook) {
  SolveWorldOptions options = Exact();
  options.views = 14;
  options.shared[kRangeOffset] = 0.03;  // measured 30 mm too short
  const SolveWorld world(options);
  const SolveSession session(world);
  const BoardSolution known = Solve(session.Joint());
  EXPECT_NEAR(known.state.shared[kRangeOffset], 0, 1e-6);
  const BoardSolution open = Solve(session.Joint(0.1));
  ASSERT_TRUE(open.converged);
  // Beams are taken from the centre's to first order in the board's size.
  EXPECT_NEAR(open.state.shared[kRangeOffset], 0.03, 1e-4);
  EXPECT_THAT(open.state.camera_from_lidar[0], Rigid3Near(world.camera_from_lidar[0], 5e-5, 2e-4));
  EXPECT_THAT(known.state.camera_from_lidar[0],
              testing::Not(Rigid3Near(world.camera_from_lidar[0], 2e-3, 4e-3)));
}

TEST(PlaneResidual, ARangeOffsetLeansATiltedBoardsPlane) {
  constexpr double kOffset = 0.03;
  const Rigid3 board{
      Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.3, 1, 0).normalized())),
      {0.2, -0.4, 2.5}};
  CloudEdges cloud;
  cloud.centre = board.translation * (1 - kOffset / board.translation.norm());
  for (double x = -0.5; x <= 0.5; x += 0.1) {
    for (double y = -0.4; y <= 0.4; y += 0.1) {
      const Eigen::Vector3d point = board * Eigen::Vector3d(x, y, 0);
      Eigen::Vector4d q(0, 0, 0, 1);
      q.head<3>() = point - kOffset * point.normalized() - cloud.centre;
      cloud.scatter += q * q.transpose();
    }
  }
  cloud.raw_scatter = cloud.scatter;
  const auto rms = [&](double offset) {
    const Eigen::Vector4d x = ResidualOf(cloud, board, offset, 0).x;
    return std::sqrt(x.dot(cloud.scatter * x) / cloud.scatter(3, 3));
  };
  EXPECT_LT(rms(kOffset), 2e-4);  // what third order leaves
  EXPECT_GT(rms(0), 0.015);
  // The lean alone: the board where the centre's own offset puts it.
  Rigid3 moved = board;
  moved.translation -= kOffset * board.translation.normalized();
  const Eigen::Vector4d flat = ResidualOf(cloud, moved, 0, 0).x;
  EXPECT_GT(std::sqrt(flat.dot(cloud.scatter * flat) / cloud.scatter(3, 3)), 1e-3);
}

TEST(PlaneResidual, BeamsThatMeetLeanAHighBoardsPlane) {
  constexpr double kMeet = 0.04;
  const Rigid3 board{
      Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.3, 1, 0).normalized())),
      {0.2, 2.4, 0.8}};
  // As a cloud has a point that such a beam met: its beam starts at -kMeet tan(elevation).
  const auto seen = [](const Eigen::Vector3d& point) {
    Eigen::Vector3d p = point;
    for (int i = 0; i < 5; ++i) p.z() = point.z() + kMeet * p.z() / p.head<2>().norm();
    return p;
  };
  CloudEdges cloud;
  cloud.centre = seen(board.translation);
  for (double x = -0.5; x <= 0.5; x += 0.1) {
    for (double y = -0.4; y <= 0.4; y += 0.1) {
      Eigen::Vector4d q(0, 0, 0, 1);
      q.head<3>() = seen(board * Eigen::Vector3d(x, y, 0)) - cloud.centre;
      cloud.scatter += q * q.transpose();
    }
  }
  cloud.raw_scatter = cloud.scatter;
  const auto rms = [&](double meet) {
    const Eigen::Vector4d x = ResidualOf(cloud, board, 0, meet).x;
    return std::sqrt(x.dot(cloud.scatter * x) / cloud.scatter(3, 3));
  };
  EXPECT_LT(rms(kMeet), 4e-4);  // what second order leaves
  EXPECT_GT(rms(0), 3e-3);
}

// What a metre of offset moves a board's points by is told by where they are, not by what they
// weigh.
TEST(PlaneResidual, WhatRowsShareDoesNotChangeWhereAnOffsetPutsTheBoard) {
  CloudEdges cloud;
  cloud.centre = {3, 0, 0};
  for (double y = -0.5; y <= 0.5; y += 0.1) {
    for (double z = -0.4; z <= 0.4; z += 0.1) {
      const Eigen::Vector4d q(0, y, z, 1);
      cloud.scatter += q * q.transpose();
    }
  }
  cloud.raw_scatter = cloud.scatter;
  const Rigid3 board{Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY())),
                     {3, 0, 0}};
  const double alone = ResidualOf(cloud, board, 0.02, 0).x[3];
  EXPECT_NEAR(alone, 0.02 * (1 - 0.5 * (0.1 + 0.0667) / 9), 5e-6);  // beams diverge
  cloud.scatter(3, 3) *= 0.05;  // of the points' weight a twentieth is left
  EXPECT_EQ(ResidualOf(cloud, board, 0.02, 0).x[3], alone);
}

TEST(PlaneResidual, DerivativesAreExact) {
  const Rigid3 board{
      Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.3, 1, 0).normalized())),
      {0.2, -0.4, 2.5}};
  CloudEdges cloud;
  cloud.centre = {0.21, -0.41, 2.48};
  cloud.scatter.diagonal() << 20, 30, 10, 300;
  cloud.raw_scatter = cloud.scatter;
  const PlaneResidual at = ResidualOf(cloud, board, 0.02, 0.03);
  constexpr double kStep = 1e-6;
  const std::array<int, 3> moves{0, 1, 5};
  for (int k = 0; k < 5; ++k) {
    const auto x = [&](double step) -> Eigen::Vector4d {
      if (k == 3) return ResidualOf(cloud, board, 0.02 + step, 0.03).x;
      if (k == 4) return ResidualOf(cloud, board, 0.02, 0.03 + step).x;
      const Vector6d delta = step * Vector6d::Unit(moves[static_cast<std::size_t>(k)]);
      return ResidualOf(cloud, board * Exp(delta), 0.02, 0.03).x;
    };
    const Eigen::Vector4d numeric = (x(kStep) - x(-kStep)) / (2 * kStep);
    EXPECT_LT((at.by.col(k) - numeric).norm(), 1e-8) << "unknown " << k;
  }
}

TEST(SolveBoards, AnImageToldFromTheOtherEndGivesTheSame) {
  SolveWorldOptions options;
  options.draw_nuisances = true;
  const SolveWorld world(options);
  const SolveSession session(world);
  JointProblem joint = session.Joint();
  const BoardSolution straight = Solve(joint);
  std::list<ImageEdges> turned;
  for (BoardView& view : joint.problem.views) {
    BoardImage& image = view.images.back();
    turned.push_back(*image.edges);
    TurnImage(&turned.back());
    image.edges = &turned.back();
    image.turned = true;
  }
  const BoardSolution same = Solve(joint);
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_THAT(same.state.camera_from_lidar[c],
                Rigid3Near(straight.state.camera_from_lidar[c], 1e-9, 1e-9));
  }
  EXPECT_THAT(same.covariance, EigenNear(straight.covariance, 1e-6 * straight.covariance.norm()));
}

TEST(SolveBoards, AWrongCornerHardlyMovesTheResult) {
  SolveWorld world;
  const SolveSession clean(world);
  const BoardSolution without = Solve(clean.Joint());
  world.ImageAt(3, 1).corners[5] += Eigen::Vector2d(5, -5);
  const SolveSession session(world);
  const BoardSolution with = Solve(session.Joint());
  for (std::size_t c = 0; c < 2; ++c) {
    const auto at = static_cast<Eigen::Index>(6 * c);
    EXPECT_LT(Chi2Of(without.state.camera_from_lidar[c], with.state.camera_from_lidar[c],
                     without.covariance.block<6, 6>(at, at)),
              0.1);
  }
}

TEST(SolveBoards, TheSameInputGivesTheSameBits) {
  const SolveWorld world;
  const SolveSession session(world);
  const BoardSolution a = Solve(session.Joint());
  const BoardSolution b = Solve(session.Joint());
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(a.state.shared, b.state.shared);
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_EQ(a.state.camera_from_lidar[c].translation, b.state.camera_from_lidar[c].translation);
    EXPECT_EQ(a.state.camera_from_lidar[c].rotation.coeffs(),
              b.state.camera_from_lidar[c].rotation.coeffs());
  }
}

TEST(SolveBoards, ItsCovarianceIsThatOfItsErrors) {
  constexpr int kSessions = 150;
  std::array<double, 2> chi2{};
  Eigen::Matrix<double, kSharedUnknowns, 1> shared2 =
      Eigen::Matrix<double, kSharedUnknowns, 1>::Zero();
  for (std::uint32_t seed = 0; seed < kSessions; ++seed) {
    SolveWorldOptions options;
    options.seed = 100 + seed;
    options.views = 6;
    options.draw_nuisances = true;
    options.side_sigma_rad = BoardPriors().side_sigma_rad;
    const SolveWorld world(options);
    const SolveSession session(world);
    const BoardSolution solution = Solve(session.Joint());
    ASSERT_TRUE(solution.converged) << seed;
    for (std::size_t c = 0; c < 2; ++c) {
      const auto at = static_cast<Eigen::Index>(6 * c);
      chi2[c] += Chi2Of(world.camera_from_lidar[c], solution.state.camera_from_lidar[c],
                        solution.covariance.block<6, 6>(at, at)) /
                 kSessions;
    }
    for (int k = 0; k < kRangeOffset; ++k) {
      const auto i = static_cast<std::size_t>(k);
      shared2[k] += std::pow(solution.state.shared[i] - world.shared[i], 2) /
                    solution.covariance(12 + k, 12 + k) / kSessions;
    }
  }
  // The mean of 150 chi-squares of 6 degrees of freedom has a sigma of sqrt(12 / 150) = 0.28.
  EXPECT_NEAR(chi2[0], 6, 0.9);
  EXPECT_NEAR(chi2[1], 6, 0.9);
  for (int k = 0; k < kRangeOffset; ++k) EXPECT_NEAR(shared2[k], 1, 0.4) << "unknown " << k;
}

}  // namespace
}  // namespace rgbdt
