// SolveBoards against Ceres: the same least squares (ceres_boards.h).
#include <Eigen/Dense>
#include <cmath>

#include "calib/solve/board_problem.h"
#include "tests/unit/solve/ceres_boards.h"
#include "tests/unit/solve/solve_world.h"

namespace rgbdt {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kOptimumSigmas = 1e-6;  // of all unknowns together
constexpr double kVarianceRatio = 0.01;

// From one state to another, in the Jacobian's unknowns.
VectorXd Between(const BoardProblem& problem, const BoardState& from, const BoardState& to) {
  std::vector<double> out;
  const auto add = [&](const Vector6d& delta) {
    out.insert(out.end(), delta.begin(), delta.end());
  };
  for (std::size_t c = 0; c < from.camera_from_lidar.size(); ++c) {
    add(Log(to.camera_from_lidar[c] * from.camera_from_lidar[c].Inverse()));
  }
  for (std::size_t k = 0; k < from.shared.size(); ++k) out.push_back(to.shared[k] - from.shared[k]);
  for (std::size_t c = 0; c < from.lenses.size(); ++c) {
    if (!problem.HasOwnLens(c)) continue;
    const LensNumbers change = NumbersOf(to.lenses[c]) - NumbersOf(from.lenses[c]);
    out.insert(out.end(), change.begin(), change.end());
  }
  for (std::size_t i = 0; i < from.range_terms.size(); ++i) {
    out.push_back(to.range_terms[i] - from.range_terms[i]);
  }
  for (std::size_t v = 0; v < from.lidar_from_target.size(); ++v) {
    add(Log(from.lidar_from_target[v].Inverse() * to.lidar_from_target[v]));
    for (std::size_t s = 0; s < 4; ++s) out.push_back(to.side_shift[v][s] - from.side_shift[v][s]);
  }
  return Eigen::Map<VectorXd>(out.data(), static_cast<Eigen::Index>(out.size()));
}

// Units of the shared unknowns in which a sigma of 1 is loose: a degree, 0.1 m (degenerate.h), and
// of the nuisances more than the prior's sigma, which none has.
VectorXd LooseUnits(const BoardProblem& problem) {
  const std::size_t cameras = problem.cameras.size();
  const SharedPlaces places(problem);
  VectorXd units(places.Count());
  for (std::size_t c = 0; c < cameras; ++c) {
    units.segment<3>(SharedPlaces::Pose(c)).setConstant(M_PI / 180);
    units.segment<3>(SharedPlaces::Pose(c) + 3).setConstant(0.1);
    units.segment<kLensNumbers>(places.Lens(c)) =
        1.1 * problem.lens_priors[c].diagonal().cwiseMax(1e-12).cwiseSqrt();
  }
  for (int k = 0; k < kSharedUnknowns; ++k) units[places.Of(k)] = 1.1 * problem.priors.Sigma(k);
  for (std::size_t i = 0; i < problem.ranges.Count(); ++i) {
    units[places.RangeTerm(i)] = 1.1 * problem.SigmaOfTerm(i);
  }
  return units;
}

// What is known of the shared unknowns, all else eliminated: by the solver's Schur blocks,
MatrixXd InformationBy(const BoardSolution& solution, const BoardProblem& problem) {
  MatrixXd sum = PriorInformation(problem, solution.state).information;
  for (const ViewInformation& view : solution.views) sum += view.information;
  const VectorXd units = LooseUnits(problem);
  return units.asDiagonal() * sum * units.asDiagonal();
}

// and by Ceres' Jacobian.
MatrixXd InformationBy(const MatrixXd& jacobian, const BoardProblem& problem) {
  const VectorXd units = LooseUnits(problem);
  const Eigen::Index unknowns = units.size();
  const MatrixXd own = jacobian.rightCols(jacobian.cols() - unknowns);
  MatrixXd rest = jacobian.leftCols(unknowns);
  rest -= own * own.colPivHouseholderQr().solve(rest);
  rest *= units.asDiagonal();
  return rest.transpose() * rest;
}

// Directions, one a column, of which an information says less than of a loose one, and the others.
struct Directions {
  explicit Directions(const MatrixXd& information) {
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(information);
    const Eigen::Index count = (eigen.eigenvalues().array() < 1).count();
    loose = eigen.eigenvectors().leftCols(count);
    held = eigen.eigenvectors().rightCols(information.cols() - count);
  }
  // Of one's loose directions, how much lies among the other's held ones.
  double Apart(const Directions& other) const {
    return std::max((held.transpose() * other.loose).norm(),
                    (other.held.transpose() * loose).norm());
  }

  MatrixXd loose, held;
};

// Of all directions, by how much a variance (or an information) differs the most.
double WorstRatio(const MatrixXd& a, const MatrixXd& b) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> eigen(a, b);
  return (eigen.eigenvalues().array() - 1).abs().maxCoeff();
}

struct SolveProblem {
  const char* name;
  int views;
  int loose = 0;  // directions
  enum { kAnyPlace, kParallel, kOnePlace } boards = kAnyPlace;
  bool edges = true;
  bool outliers = false;
  double range_offset_sigma_m = 0;
  bool lens = false;  // unknown, and the print's size
  bool sides_bent = false;
  bool rings = false;     // and octaves are off, and beams meet
  bool sessions = false;  // two of them, of one rig, its cameras moved in between
};

void PrintTo(const SolveProblem& problem, std::ostream* out) { *out << problem.name; }

void AddOutliers(SolveWorld* world) {
  world->ImageAt(2, 0).corners[5] += Eigen::Vector2d(2, -3);
  world->ImageAt(1, 1).corners[17] += Eigen::Vector2d(-4, 1);
  for (Eigen::Vector2d& p : world->ImageAt(0, 1).sides[2].curve) p.y() += 1.5;
  for (const std::size_t i : {3, 30, 60}) world->CloudAt(1).crossings[i].point.y() += 0.04;
}

void TakeEdgesAway(SolveWorld* world) {
  for (ViewDetection& detection : world->detections) {
    for (ImageDetection& image : detection.images) {
      for (ImageSide& side : image.edges->sides) side.seen = false;
    }
    for (CloudEdges& cloud : detection.cloud.candidates) cloud.crossings.clear();
  }
}

SolveWorld WorldOf(const SolveProblem& problem) {
  SolveWorldOptions options;
  options.seed = 40 + static_cast<std::uint32_t>(problem.views);
  options.views = 0;
  // Parallel planes are so only without noise.
  options.noise = problem.edges || problem.views == 1 ? 1 : 0;
  options.draw_nuisances = true;
  options.side_sigma_rad = BoardPriors().side_sigma_rad;
  if (problem.lens) {
    options.lens_uncertainty.reset();
    options.print_sigma = kUsualPrintSigma;
  }
  if (problem.rings) options.rings = {0.01, 0.015, 0.004, 0.03};
  SolveWorld world(options);
  const Rigid3 first = world.AnyBoard();
  while (static_cast<int>(world.lidar_from_target.size()) < problem.views) {
    Rigid3 board = world.AnyBoard();
    if (problem.boards == SolveProblem::kParallel) board.rotation = first.rotation;
    if (problem.boards == SolveProblem::kOnePlace) board.translation = first.translation;
    if (!world.Seen(board)) continue;
    if (problem.sessions &&
        2 * world.detections.size() == static_cast<std::size_t>(problem.views)) {
      world.MoveCameras(0.01, 0.01);
    }
    world.AddView(board);
  }
  if (!problem.edges) TakeEdgesAway(&world);
  if (problem.outliers) AddOutliers(&world);
  return world;
}

void OpenRanges(JointProblem* joint) {
  RangeTerms& ranges = joint->problem.ranges;
  for (int ring = 0; ring < 16; ++ring) ranges.rings.push_back(ring);
  ranges.first_octave = -4;
  ranges.octaves = 5;
  ranges.shares.assign(16, 1.0 / 16);
  ranges.shares.insert(ranges.shares.end(), {0.1, 0.3, 0.1, 0.2, 0.3});
  joint->problem.priors.ring_sigma_m = 0.01;
  joint->problem.priors.octave_sigma_m = 0.008;
  joint->problem.priors.ring_view_sigma_m = 0.004;
  joint->start.range_terms.assign(ranges.Count(), 0);
}

BoardState NearStart(const JointProblem& joint) {
  Random random(5);
  BoardState start = joint.start;
  for (Rigid3& pose : start.camera_from_lidar) {
    pose = RotationAbout(random.Direction(), 0.02) * pose;
    pose.translation += 0.02 * random.Direction();
  }
  return start;
}

// One call stops where its last step was short of a hundredth of a sigma.
BoardSolution SolveToTheEnd(const BoardProblem& problem, const BoardState& start) {
  BoardSolution solution = SolveBoards(problem, start);
  for (int i = 0; i < 40 && solution.converged; ++i) {
    solution = SolveBoards(problem, solution.state);
  }
  return solution;
}

class SolveBoardsAndCeres : public testing::TestWithParam<SolveProblem> {};
INSTANTIATE_TEST_SUITE_P(
    Problems, SolveBoardsAndCeres,
    testing::Values(
        SolveProblem{"TenViews", 10}, SolveProblem{"FourViews", 4},
        SolveProblem{"RangeOffset", 8, 0, SolveProblem::kAnyPlace, true, false, 0.1},
        SolveProblem{"Lens", 8, 0, SolveProblem::kAnyPlace, true, false, 0.1, true},
        SolveProblem{"LensOfOneView", 1, 5, SolveProblem::kAnyPlace, true, false, 0, true},
        SolveProblem{"BentSides", 6, 0, SolveProblem::kAnyPlace, true, false, 0, false, true},
        SolveProblem{"Rings", 6, 0, SolveProblem::kAnyPlace, true, false, 0.1, false, false, true},
        SolveProblem{"Sessions", 8, 0, SolveProblem::kAnyPlace, true, false, 0.1, true, false,
                     false, true},
        SolveProblem{"Outliers", 5, 0, SolveProblem::kAnyPlace, true, true},
        SolveProblem{"OutliersOfMany", 12, 0, SolveProblem::kAnyPlace, true, true},
        SolveProblem{"Parallel", 6, 0, SolveProblem::kParallel},
        SolveProblem{"OnePlace", 7, 0, SolveProblem::kOnePlace}, SolveProblem{"OneView", 1},
        SolveProblem{"ParallelWithoutEdges", 9, 3, SolveProblem::kParallel, false},
        SolveProblem{"OneViewWithoutEdges", 1, 3, SolveProblem::kAnyPlace, false}),
    [](const auto& info) { return std::string(info.param.name); });

TEST_P(SolveBoardsAndCeres, FindTheSame) {
  const SolveWorld world = WorldOf(GetParam());
  SolveSession session(world);
  // `world` knows where cameras are in the end; the solve starts from there in both sessions.
  if (GetParam().sessions) session.Divide(world.detections.size() / 2, world.camera_from_lidar);
  JointProblem joint = session.Joint(GetParam().range_offset_sigma_m);
  if (GetParam().rings) OpenRanges(&joint);
  if (GetParam().sides_bent) joint.problem.priors.image_side_sigma_m = 0.0005;
  const BoardSolution ours = SolveToTheEnd(joint.problem, NearStart(joint));
  // Its own last step ends where rounding hides what the cost still falls by.
  const BoardState theirs =
      SolveByCeres(joint.problem, SolveByCeres(joint.problem, NearStart(joint)));
  const MatrixXd jacobian = JacobianByCeres(joint.problem, ours.state);
  // All unknowns' distance in sigmas; loose directions count for nothing.
  EXPECT_LT((jacobian * Between(joint.problem, ours.state, theirs)).norm(), kOptimumSigmas);

  const MatrixXd by_us = InformationBy(ours, joint.problem);
  const MatrixXd by_ceres = InformationBy(jacobian, joint.problem);
  const Directions directions(by_ceres);
  EXPECT_EQ(directions.loose.cols(), GetParam().loose);
  EXPECT_LT(Directions(by_us).Apart(directions), 1e-6);
  const MatrixXd& held = directions.held;
  EXPECT_LT(WorstRatio(held.transpose() * by_us * held, held.transpose() * by_ceres * held),
            kVarianceRatio);
  if (GetParam().loose > 0) return;  // no covariance
  const VectorXd per_unit = LooseUnits(joint.problem).cwiseInverse();
  const MatrixXd covariance = per_unit.asDiagonal() * ours.covariance * per_unit.asDiagonal();
  EXPECT_LT(WorstRatio(covariance, by_ceres.inverse()), kVarianceRatio);
}

}  // namespace
}  // namespace rgbdt
