#include "calib/methods/edge_grid/by_edge_grid.h"

#include <string>
#include <utility>

#include "calib/methods/edge_grid/depth_jumps.h"
#include "calib/methods/edge_grid/edge_field.h"
#include "calib/methods/scene/seen_points.h"
#include "calib/model/errors.h"

namespace rgbdt {
namespace {

bool IsFar(const Rigid3& start, const Rigid3& pose, const PoseSteps& reach) {
  return StepsBetween(start, pose, reach).cwiseAbs().maxCoeff() > 1;
}

// Halves the steps wherever no neighbour is better.
Rigid3 SearchGrid(const PoseObjective& objective, const Rigid3& start,
                  const EdgeGridOptions& options) {
  Rigid3 best = start;
  double value = objective(start);
  PoseSteps steps = options.first_step;
  for (int halved = 0; halved <= options.halvings && !IsFar(start, best, options.reach);) {
    const Rigid3 centre = best;
    bool better = false;
    ForEachNeighbour(centre, steps, [&](const Rigid3& neighbour) {
      const double there = objective(neighbour);
      if (!(there > value)) return;
      value = there;
      best = neighbour;
      better = true;
    });
    if (better) continue;
    steps = steps * 0.5;
    ++halved;
  }
  return best;
}

}  // namespace

void EdgeGridOptions::Check() const {
  if (!(gamma > 0 && gamma < 1)) {
    throw InputError("edge grid: gamma is " + std::to_string(gamma) + "; expected 0 to 1");
  }
  if (!(alpha >= 0 && alpha <= 1)) {
    throw InputError("edge grid: alpha is " + std::to_string(alpha) + "; expected 0 to 1");
  }
  if (!(first_step.rotation_rad > 0) || !(first_step.translation_m > 0)) {
    throw InputError("edge grid: first_step is " + std::to_string(first_step.rotation_rad) +
                     " rad and " + std::to_string(first_step.translation_m) +
                     " m; expected more than 0");
  }
}

EdgesOnEdges::EdgesOnEdges(const CameraSpec& camera, const std::vector<Shot>& shots,
                           const Rigid3& near, const EdgeGridOptions& options)
    : camera_(camera) {
  const std::vector<cv::Mat> grey = GreyValues(camera, shots);
  for (std::size_t s = 0; s < shots.size(); ++s) {
    const std::vector<DepthJump> all = DepthJumpsOf(*shots[s].cloud, options.least_step_m);
    std::vector<Eigen::Vector3f> points;
    for (const DepthJump& edge : all) points.push_back(edge.point);
    Edges edges;
    for (const std::size_t i : PointsNearImage(camera_, near, points, options.most_points)) {
      edges.points.push_back(points[i]);
      edges.weight.push_back(all[i].weight);
    }
    edges.field = InverseDistanceTransform(EdgeImage(grey[s]), options.alpha, options.gamma);
    shots_.push_back(std::move(edges));
  }
}

EdgesOnEdges::Sum EdgesOnEdges::At(const Rigid3& camera_from_lidar) const {
  Sum sum;
  for (const Edges& shot : shots_) {
    ForEachSeen(camera_, camera_from_lidar, shot.points, [&](std::size_t i, float u, float v) {
      sum.value += static_cast<double>(shot.weight[i] * Interpolated(shot.field, u, v));
      ++sum.seen;
    });
  }
  return sum;
}

SceneFit AlignByEdgeGrid(const CameraSpec& camera, const std::vector<Shot>& shots,
                         const Rigid3& start, const EdgeGridOptions& options) {
  options.Check();
  const EdgesOnEdges edges(camera, shots, start, options);
  const PoseObjective objective = [&](const Rigid3& pose) { return edges.At(pose).value; };
  SceneFit fit;
  fit.camera_from_lidar = SearchGrid(objective, start, options);
  const Rigid3& found = fit.camera_from_lidar;
  fit.why_not =
      WhyTooFew(edges.At(found).seen, options.least_points, "points at depth discontinuities");
  if (fit.why_not.empty() && IsFar(start, found, options.reach)) {
    fit.why_not = WhyAtBorder(options.reach);
  }
  if (fit.why_not.empty()) {
    fit.why_not = WhyNoPeak(ShareWorse(objective, found, options.first_step), options.least_worse,
                            options.first_step);
  }
  fit.converged = fit.why_not.empty();
  return fit;
}

}  // namespace rgbdt
