#include "calib/solve/internal/held_offsets.h"

#include <cmath>

#include "calib/solve/internal/scatter_sigmas.h"

namespace rgbdt {

std::vector<RefutedOffset> HeldOffsets(const BoardProblem& problem) {
  std::vector<RefutedOffset> held;
  const double reference = problem.priors.range_offset_sigma_m;
  if (reference < kRangeOffsetSigmaM && problem.PatternIsSeen()) {
    held.push_back({std::nullopt, reference});
  }
  for (std::size_t l = 0; l < problem.lidars.size(); ++l) {
    const double known = problem.lidars[l].priors.range_offset_sigma_m;
    if (known < kRangeOffsetSigmaM) held.push_back({l, known});
  }
  return held;
}

std::vector<RefutedOffset> RefutedOf(const std::vector<RefutedOffset>& held,
                                     const JointResult& result, double sigmas) {
  std::vector<RefutedOffset> refuted;
  for (const RefutedOffset& offset : held) {
    const Estimate free = FreeRangeOffset(result.joint.problem, result.solution, offset.lidar);
    const double factor =
        offset.lidar ? result.lidar_factors[*offset.lidar] : result.variance_factor;
    const double sigma = std::sqrt(factor) * free.sigma;
    // NaN, where the views say nothing, refutes nothing.
    if (std::abs(free.value) > sigmas * std::hypot(sigma, offset.known_m)) {
      refuted.push_back(offset);
    }
  }
  return refuted;
}

void FreeOffset(const RefutedOffset& offset, BoardProblem* problem) {
  BoardProblem* of_lidar = offset.lidar ? &problem->lidars[*offset.lidar] : problem;
  of_lidar->priors.range_offset_sigma_m = kRangeOffsetSigmaM;
  of_lidar->ranges_exact = false;
  OpenBeams(of_lidar);
}

}  // namespace rgbdt
