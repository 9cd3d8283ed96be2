#include "calib/solve/internal/edges_planes.h"

#include <cmath>
#include <deque>
#include <optional>
#include <utility>

#include "calib/model/comparison.h"
#include "calib/model/text.h"
#include "calib/solve/internal/further_lidars.h"

namespace rgbdt {

namespace {

constexpr double kPoseFreedom = 6;
constexpr double kSettled = 1e-2;  // a tenth of a sigma

// By the boards' edges alone, and by their planes alone; nothing where one does not tell.
struct EdgesAndPlanes {
  BoardSolution edges, planes;
};

std::optional<EdgesAndPlanes> SolveApart(const BoardProblem& all, const BoardState& state) {
  BoardProblem edges = all;
  BoardProblem planes = all;
  std::deque<ImageEdges> without_sides;
  for (BoardView& view : edges.views) view.cloud.scatter_sigma_m = 0;
  for (BoardProblem& lidar : edges.lidars) {
    for (BoardView& view : lidar.views) view.cloud.scatter_sigma_m = 0;
  }
  for (BoardProblem& lidar : planes.lidars) {
    for (BoardView& view : lidar.views) view.cloud.crossings.clear();
  }
  for (BoardView& view : planes.views) {
    view.cloud.crossings.clear();
    for (BoardImage& image : view.images) {
      if (image.edges->corners.empty()) continue;  // its sides are all that it tells
      without_sides.push_back(*image.edges);
      without_sides.back().sides = {};
      image.edges = &without_sides.back();
    }
  }
  EdgesAndPlanes apart{SolveBoards(edges, state, kSettled), SolveBoards(planes, state, kSettled)};
  if (!apart.edges.converged || !apart.planes.converged) return std::nullopt;
  return apart;
}

}  // namespace

JointResult HoldEdgesAgainstPlanes(JointResult result) {
  const BoardProblem& all = result.joint.problem;
  if (all.views.size() < 4) return result;
  // Further LIDARs by themselves: planes of a few views do not tell where one is, and would then
  // tell nothing of the cameras.
  BoardProblem cameras = all;
  BoardState state = result.solution.state;
  cameras.lidars.clear();
  state.lidars.clear();
  if (const auto apart = SolveApart(cameras, state)) {
    for (std::size_t c = 0; c < result.joint.cameras.size(); ++c) {
      result.joint.cameras[c].views.report.edges_planes =
          Apart(apart->edges, apart->planes, result.variance_factor, c);
    }
  }
  result.lidars_edges_planes.clear();
  if (all.lidars.empty()) return result;
  const auto apart = SolveApart(all, result.solution.state);
  for (std::size_t l = 0; l < all.lidars.size(); ++l) {
    std::optional<Halves> differ;
    if (apart && CloudsOf(all, l) >= 4) differ = LidarApart(apart->edges, apart->planes, result, l);
    result.lidars_edges_planes.push_back(differ);
  }
  return result;
}

std::string EnlargedWords(double chi2, double factor) {
  return Format(
      "edges alone and planes alone contradict each other (chi-square %.1f, %.0f expected): "
      "the stated sigma was enlarged %.1f times, until they agree",
      chi2, kPoseFreedom, std::sqrt(factor));
}

double FactorWhereTheyDiffer(const Halves& edges_planes) {
  return edges_planes.chi2 > kUnlikelyChi2 ? edges_planes.chi2 / kPoseFreedom : 1;
}

CameraReport EnlargedWhereTheyDiffer(CameraReport report) {
  CameraCalibration& calibration = report.calibration;
  if (!report.edges_planes || !calibration.covariance) return report;
  const double factor = FactorWhereTheyDiffer(*report.edges_planes);
  if (factor == 1) return report;
  report.edges_planes->sigma_enlarged = std::sqrt(factor);
  report.warnings.push_back(EnlargedWords(report.edges_planes->chi2, factor));
  *calibration.covariance *= factor;
  if (calibration.lens) calibration.lens->covariance *= factor;
  for (Cause& cause : report.causes) {
    if (cause.moves_sigma) *cause.moves_sigma /= std::sqrt(factor);
  }
  return report;
}

}  // namespace rgbdt
