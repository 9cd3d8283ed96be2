#include "calib/solve/internal/view_scatter.h"

#include <algorithm>
#include <cmath>

#include "calib/model/linear_algebra.h"
#include "calib/model/rigid3.h"
#include "calib/solve/internal/evidence.h"

namespace rgbdt {
namespace {

using Index = Eigen::Index;

// The result without every `parts`-th view from `part` on.
BoardSolution Without(const BoardProblem& problem, const BoardSolution& all, std::size_t part,
                      std::size_t parts) {
  std::vector<std::size_t> others;
  for (std::size_t v = 0; v < problem.views.size(); ++v) {
    if (v % parts != part) others.push_back(v);
  }
  return SolveSome(problem, all, others);
}

}  // namespace

std::vector<Contradiction> Contradictions(const BoardProblem& problem,
                                          const BoardSolution& solution) {
  const auto cameras = static_cast<Index>(6 * problem.cameras.size());
  // Nuisances as they are: a view's own and the others' then add up.
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(cameras, cameras);
  for (const ViewInformation& view : solution.views) {
    all += view.information.topLeftCorner(cameras, cameras);
  }
  std::vector<Contradiction> out;
  for (std::size_t v = 0; v < problem.views.size(); ++v) {
    const BoardView& view = problem.views[v];
    // The view's cameras only: of others it says nothing.
    std::vector<Index> place;
    for (const BoardImage& image : view.images) {
      for (Index k = 0; k < 6; ++k) place.push_back(6 * image.camera + k);
    }
    const auto own = Eigen::MatrixXd(
        solution.views[v].information.topLeftCorner(cameras, cameras)(place, place));
    const auto gradient = Eigen::VectorXd(solution.views[v].gradient.head(cameras)(place));
    const Eigen::MatrixXd others =
        all - solution.views[v].information.topLeftCorner(cameras, cameras);
    const Eigen::MatrixXd others_covariance = InverseOfSymmetric(others)(place, place);
    const Eigen::MatrixXd covariance = InverseOfSymmetric(own) + others_covariance;
    const Eigen::VectorXd off = covariance * gradient;
    for (std::size_t s = 0; s < view.images.size(); ++s) {
      const auto at = static_cast<Index>(6 * s);
      const Matrix6d block = covariance.block<6, 6>(at, at);
      const Vector6d delta = off.segment<6>(at);
      Contradiction c;
      c.view = v;
      c.image = s;
      c.chi2 = delta.dot(SolveSymmetric(block, delta));
      c.rotation_deg = delta.head<3>().norm() * 180 / M_PI;
      c.centre_mm = delta.tail<3>().norm() * 1000;
      if (std::isfinite(c.chi2)) out.push_back(c);  // not where no other view has this camera
    }
  }
  return out;
}

double AsStated(const std::vector<Contradiction>& contradictions, std::size_t views) {
  if (contradictions.empty()) return ShareAsStated(1, 0);
  double chi2 = 0;
  for (const Contradiction& c : contradictions) chi2 += c.chi2;
  // Images of one view share its cloud, and count once.
  return ShareAsStated(chi2 / (6 * static_cast<double>(contradictions.size())),
                       6 * (static_cast<double>(views) - 1));
}

std::optional<ViewScatter> ViewScatterOf(const BoardProblem& problem,
                                         const BoardSolution& solution) {
  constexpr std::size_t kMostParts = 10;
  const std::size_t views = problem.views.size();
  if (views < 4) return std::nullopt;
  const std::size_t parts = std::min(views, kMostParts);
  double moved = 0;
  double expected = 0;
  double expected2 = 0;
  for (std::size_t part = 0; part < parts; ++part) {
    const BoardSolution without = Without(problem, solution, part, parts);
    for (std::size_t c = 0; c < problem.cameras.size(); ++c) {
      const auto at = static_cast<Index>(6 * c);
      const Matrix6d covariance = solution.covariance.block<6, 6>(at, at);
      const Matrix6d covariance_without = without.covariance.block<6, 6>(at, at);
      const Matrix6d more = SolveSymmetric(covariance, covariance_without) - Matrix6d::Identity();
      const Vector6d move =
          Log(without.state.camera_from_lidar[c] * solution.state.camera_from_lidar[c].Inverse());
      moved += move.dot(SolveSymmetric(covariance, move));
      expected += more.trace();
      expected2 += (more * more).trace();
    }
  }
  if (!(expected > 0) || !std::isfinite(moved)) return std::nullopt;
  // Cameras of one view share its cloud: their moves are correlated, and count but once.
  std::size_t together = 1;
  for (const BoardView& view : problem.views) {
    together = std::max(together, view.images.size());
  }
  const double chance = std::sqrt(2 * expected2 * static_cast<double>(together)) / expected;
  return ViewScatter{moved / expected, 2 / (chance * chance)};
}

}  // namespace rgbdt
