#pragma once

#include "calib/methods/scene/pose_search.h"

namespace rgbdt {

struct AscentOptions {
  PoseSteps unit;           ///< of the six unknowns, so that they weigh alike
  double difference = 0.1;  ///< of the numeric derivatives [units]
  double max_step = 0.5;    ///< longest step [units]
  double tolerance = 1e-3;  ///< a step shorter than this ends the ascent [units]
  double reach = 4;         ///< how far from the start it may go, along any component [units]
  int max_iterations = 100;
};

struct AscentResult {
  Rigid3 pose;             ///< the best that was met
  double value = 0;        ///< of the objective there
  bool converged = false;  ///< steps became short
  bool at_border = false;  ///< it left the reach, and ended
};

/// Gradient ascent with steps after Barzilai and Borwein (1988), as in algorithm 1 of Pandey et al.
/// (2012): a step is s.s / |s.y| times the gradient, s being the last step and y the gradient's
/// change over it. Gradients are central differences.
AscentResult Ascend(const PoseObjective& objective, const Rigid3& start,
                    const AscentOptions& options);

}  // namespace rgbdt
