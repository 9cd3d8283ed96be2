#include "calib/solve/internal/swap_reference.h"

#include <utility>

namespace rgbdt {
namespace {

// Those of the board and of its images stay where they are.
void SwapPriorsOfLidar(BoardPriors* a, BoardPriors* b) {
  std::swap(*a, *b);
  std::swap(a->thickness_m, b->thickness_m);
  std::swap(a->thickness_sigma_m, b->thickness_sigma_m);
  std::swap(a->outline_sigma_m, b->outline_sigma_m);
  std::swap(a->image_side_sigma_m, b->image_side_sigma_m);
  std::swap(a->print_sigma, b->print_sigma);
  std::swap(a->bow_sigma_m, b->bow_sigma_m);
}

}  // namespace

void SwapReference(std::size_t lidar, BoardProblem* problem, BoardState* state) {
  BoardProblem& other = problem->lidars[lidar];
  for (std::size_t v = 0; v < problem->views.size(); ++v) {
    std::swap(problem->views[v].cloud, other.views[v].cloud);
    std::swap(problem->views[v].sides, other.views[v].sides);
  }
  SwapPriorsOfLidar(&problem->priors, &other.priors);
  std::swap(problem->ranges, other.ranges);
  std::swap(problem->ranges_exact, other.ranges_exact);
  LidarState& of_other = state->lidars[lidar];
  const Rigid3 reference_from_lidar = of_other.reference_from_lidar;
  const Rigid3 lidar_from_reference = reference_from_lidar.Inverse();
  for (Rigid3& pose : state->camera_from_lidar) pose = pose * reference_from_lidar;
  for (Rigid3& board : state->lidar_from_target) board = lidar_from_reference * board;
  for (LidarState& further : state->lidars) {
    further.reference_from_lidar = lidar_from_reference * further.reference_from_lidar;
  }
  of_other.reference_from_lidar = lidar_from_reference;
  for (int k = 0; k < kSharedUnknowns; ++k) {
    const auto i = static_cast<std::size_t>(k);
    if (IsOfLidar(k)) std::swap(state->shared[i], of_other.shared[i]);
  }
  std::swap(state->range_terms, of_other.range_terms);
  std::swap(state->side_shift, of_other.side_shift);
}

}  // namespace rgbdt
