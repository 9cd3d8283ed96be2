#include "calib/solve/internal/scatter_sigmas.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/model/linear_algebra.h"
#include "calib/model/statistics.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

using Index = Eigen::Index;

constexpr double kSideSigmas = 4;
const char* const kSideNames[] = {"top", "right", "bottom", "left"};

}  // namespace

double SideSigma(const BoardProblem& problem, const BoardSolution& solution) {
  const double prior = problem.priors.side_sigma_rad;
  double sum = 0;
  double told = 0;
  for (std::size_t v = 0; v < problem.views.size(); ++v) {
    for (std::size_t side = 0; side < 4; ++side) {
      if (!problem.views[v].sides[side]) continue;
      const double shift = solution.state.side_shift[v][side];
      sum += shift * shift;
      told += 1 - solution.side_variance[v][side] / (prior * prior);
    }
  }
  const double least = BoardPriors().side_sigma_rad;
  return told > 1 ? std::max(least, std::sqrt(sum / told)) : least;
}

Estimate FreeRangeOffset(const BoardProblem& problem, const BoardSolution& solution,
                         std::optional<std::size_t> lidar) {
  const SharedPlaces places(problem);
  const Index at = lidar ? places.Of(*lidar, kRangeOffset) : places.Of(kRangeOffset);
  const auto& shared = lidar ? solution.state.lidars[*lidar].shared : solution.state.shared;
  const double offset = shared[kRangeOffset];
  ViewInformation all = PriorInformation(problem, solution.state);
  all.information(at, at) = 1 / (kRangeOffsetSigmaM * kRangeOffsetSigmaM);
  all.gradient[at] = -offset * all.information(at, at);
  for (const ViewInformation& view : solution.views) {
    all.information += view.information;
    all.gradient += view.gradient;
  }
  const Eigen::MatrixXd covariance = InverseOfSymmetric(all.information);
  const Eigen::VectorXd step = covariance * all.gradient;
  return {offset + step[at], std::sqrt(covariance(at, at))};
}

std::string RangesAreOff(const Estimate& offset, double known_m) {
  return Format(
      "the LIDAR's ranges are %.1f +- %.1f mm too %s; the rig file has them exact to %.1f "
      "mm (lidar.range_offset_sigma_m). The views decided. Check the ranges against a tape "
      "measure, and raise that number",
      1000 * std::abs(offset.value), 1000 * offset.sigma, offset.value > 0 ? "short" : "long",
      1000 * known_m);
}

double ImageSideSigma(const BoardProblem& problem, const BoardState& state) {
  std::vector<double> off;
  std::vector<double> sigma;
  for (std::size_t v = 0; v < problem.views.size(); ++v) {
    for (const ImageSideEnd& end : ImageSideEnds(problem, state, v)) {
      off.push_back(std::abs(end.beside_m));
      sigma.push_back(end.sigma_m);
    }
  }
  if (off.size() < 16) return 0;
  const double scatter = Median(std::move(off)) / 0.6745;
  const double stated = Median(std::move(sigma));
  return scatter * scatter > 2 * stated * stated ? std::sqrt(scatter * scatter - stated * stated)
                                                 : 0;
}

std::optional<UnlikelySide> LeastLikelySide(const BoardProblem& problem,
                                            const std::vector<std::array<double, 4>>& side_shift) {
  std::optional<UnlikelySide> worst;
  double most = kSideSigmas * problem.priors.side_sigma_rad;
  for (std::size_t v = 0; v < problem.views.size(); ++v) {
    for (std::size_t s = 0; s < 4; ++s) {
      // A rectangle needs three.
      const auto& sides = problem.views[v].sides;
      if (!sides[s] || std::count(sides.begin(), sides.end(), true) < 4) continue;
      const double shift = std::abs(side_shift[v][s]);
      if (shift <= most) continue;
      most = shift;
      worst = UnlikelySide{v, s, shift};
    }
  }
  return worst;
}

std::string SideIsOut(const std::string& view, const UnlikelySide& side) {
  return "view " + view + ": the board's " + kSideNames[side.side] + " side in the cloud lies " +
         Fixed(side.shift_rad * 1000, 1) +
         " mrad from where the other sides put it; that side is left out, the view is used";
}

}  // namespace rgbdt
