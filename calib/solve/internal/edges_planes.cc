#include "calib/solve/internal/edges_planes.h"

#include <cmath>
#include <deque>
#include <utility>

#include "calib/model/comparison.h"
#include "calib/model/text.h"

namespace rgbdt {

JointResult HoldEdgesAgainstPlanes(JointResult result) {
  constexpr double kSettled = 1e-2;  // a tenth of a sigma
  if (result.joint.problem.views.size() < 4) return result;
  const BoardProblem& all = result.joint.problem;
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
    if (!all.target.HasPattern()) continue;
    for (BoardImage& image : view.images) {
      without_sides.push_back(*image.edges);
      without_sides.back().sides = {};
      image.edges = &without_sides.back();
    }
  }
  const BoardSolution by_edges = SolveBoards(edges, result.solution.state, kSettled);
  const BoardSolution by_planes = SolveBoards(planes, result.solution.state, kSettled);
  if (!by_edges.converged || !by_planes.converged) return result;
  for (std::size_t c = 0; c < result.joint.cameras.size(); ++c) {
    result.joint.cameras[c].views.report.edges_planes =
        Apart(by_edges, by_planes, result.variance_factor, c);
  }
  return result;
}

CameraReport EnlargedWhereTheyDiffer(CameraReport report) {
  constexpr double kFreedom = 6;
  CameraCalibration& calibration = report.calibration;
  if (!report.edges_planes || !calibration.covariance) return report;
  if (!(report.edges_planes->chi2 > kUnlikelyChi2)) return report;
  const double factor = report.edges_planes->chi2 / kFreedom;
  report.edges_planes->sigma_enlarged = std::sqrt(factor);
  report.warnings.push_back(
      Format("edges alone and planes alone contradict each other (chi-square %.1f, %.0f expected): "
             "the stated sigma was enlarged %.1f times, until they agree",
             factor * kFreedom, kFreedom, std::sqrt(factor)));
  *calibration.covariance *= factor;
  if (calibration.lens) calibration.lens->covariance *= factor;
  for (Cause& cause : report.causes) {
    if (cause.moves_sigma) *cause.moves_sigma /= std::sqrt(factor);
  }
  return report;
}

}  // namespace rgbdt
