#pragma once

#include <cstdint>

#include "calib/methods/scene/pose_search.h"

namespace rgbdt {

/// Particle swarm (Kennedy and Eberhart 1995) with the constriction of Clerc and Kennedy (2002).
struct SwarmOptions {
  PoseSteps reach{3 * 0.017453292519943295, 0.1};  ///< half the box's width about the start
  int particles = 60;                              ///< drawn evenly in the box; one at the start
  int rounds = 60;                                 ///< in each of which every particle moves once
  std::uint64_t seed = 1;

  /// Throws InputError naming the field and its value.
  void Check() const;
};

struct SwarmResult {
  Rigid3 pose;             ///< the best that any particle found
  double value = 0;        ///< of the objective there
  bool at_border = false;  ///< the pose lies at a side of the box
};

/// The pose in a box about `start` where the objective is largest, as far as a swarm finds it. The
/// same input gives the same bits.
SwarmResult MaximiseBySwarm(const PoseObjective& objective, const Rigid3& start,
                            const SwarmOptions& options);

}  // namespace rgbdt
