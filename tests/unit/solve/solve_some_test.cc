// Views left out by the step from the normal equations at hand, against solves from the start.
#include <algorithm>
#include <cmath>

#include "calib/model/linear_algebra.h"
#include "calib/solve/board_problem.h"
#include "tests/unit/solve/solve_world.h"

namespace rgbdt {
namespace {

SolveWorldOptions Session(int views, std::uint32_t seed) {
  SolveWorldOptions options;
  options.views = views;
  options.seed = seed;
  options.draw_nuisances = true;
  options.side_sigma_rad = BoardPriors().side_sigma_rad;
  options.lens_uncertainty.reset();  // unknowns, too
  return options;
}

std::vector<std::size_t> AllBut(std::size_t views, std::size_t part, std::size_t parts) {
  std::vector<std::size_t> out;
  for (std::size_t v = 0; v < views; ++v) {
    if (v % parts != part) out.push_back(v);
  }
  return out;
}

struct Worst {
  double sigmas = 0, variance = 0;  // of a pose; of its covariance, relative
  int by_step = 0;                  // parts that SolveBoards had no say in
};

// Of all cameras and parts.
Worst AgainstSolves(const JointProblem& joint, std::size_t parts) {
  const BoardSolution all = SolveBoards(joint.problem, joint.start);
  Worst worst;
  for (std::size_t part = 0; part < parts; ++part) {
    const auto views = AllBut(joint.problem.views.size(), part, parts);
    const BoardSolution some = SolveSome(joint.problem, all, views);
    const BoardStart anew = Part(joint.problem, views, all.state);
    const BoardSolution solved = SolveBoards(anew.problem, anew.start);
    EXPECT_TRUE(some.converged);
    worst.by_step += some.iterations == 0 ? 1 : 0;
    for (std::size_t c = 0; c < joint.cameras.size(); ++c) {
      const auto at = static_cast<Eigen::Index>(6 * c);
      const Matrix6d covariance = solved.covariance.block<6, 6>(at, at);
      const Vector6d off =
          Log(some.state.camera_from_lidar[c] * solved.state.camera_from_lidar[c].Inverse());
      worst.sigmas = std::max(worst.sigmas, std::sqrt(off.dot(SolveSymmetric(covariance, off))));
      const Matrix6d more = some.covariance.block<6, 6>(at, at) - covariance;
      worst.variance = std::max(worst.variance, more.norm() / covariance.norm());
    }
  }
  return worst;
}

TEST(SolveSome, IsTheSolveFromTheViewsThatAreLeft) {
  int by_step = 0;
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    for (const int views : {6, 12, 30}) {
      const SolveWorld world(Session(views, seed));
      const SolveSession session(world);
      const JointProblem joint = session.Joint(0.02);
      for (const std::size_t parts : {2U, 5U, 10U}) {
        const Worst worst =
            AgainstSolves(joint, std::min<std::size_t>(parts, joint.problem.views.size()));
        // A solve has settled when a step is a hundredth of all unknowns' sigma together.
        EXPECT_LT(worst.sigmas, 0.01) << views << " views, " << parts << " parts";
        EXPECT_LT(worst.variance, 0.01) << views << " views, " << parts << " parts";
        by_step += worst.by_step;
      }
    }
  }
  EXPECT_GT(by_step, 75);  // of 3 (16 + 17 + 17)
}

// The wrong view bends what its neighbours seem to be: without it, their robust weights change.
TEST(SolveSome, WithoutAWrongViewItIsTheSolveFromTheOthers) {
  SolveWorld world(Session(10, 7));
  for (std::size_t c = 0; c < 2; ++c) {
    for (Eigen::Vector2d& corner : world.ImageAt(4, c).corners) corner.x() += 3;
  }
  for (Crossing& crossing : world.CloudAt(4).crossings) crossing.point.z() += 0.05;
  const SolveSession session(world);
  const Worst worst = AgainstSolves(session.Joint(0.02), 10);
  EXPECT_LT(worst.sigmas, 0.01);
  EXPECT_LT(worst.variance, 0.01);
}

TEST(SolveSome, OfAllViewsItIsTheSolution) {
  const SolveWorld world(Session(8, 5));
  const SolveSession session(world);
  const JointProblem joint = session.Joint();
  const BoardSolution all = SolveBoards(joint.problem, joint.start);
  const BoardSolution same = SolveSome(joint.problem, all, AllBut(8, 8, 9));
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_THAT(same.state.camera_from_lidar[c],
                Rigid3Near(all.state.camera_from_lidar[c], 1e-5, 1e-5));
  }
  EXPECT_LT((same.covariance - all.covariance).norm(), 1e-3 * all.covariance.norm());
}

}  // namespace
}  // namespace rgbdt
