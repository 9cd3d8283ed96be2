#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "calib/solve/board_problem.h"
#include "calib/solve/camera_views.h"
#include "calib/solve/guess_cameras.h"

namespace rgbdt {

/// Cameras that are solved together.
struct JointProblem {
  BoardProblem problem;
  BoardState start;
  std::vector<GuessedCamera> cameras;  ///< in the order of problem.cameras
};

/// The boards of all views used, of cameras that all have a guess, each brought into one set of
/// axes for all cameras: the target's own, where one of them knows it. A view whose camera takes
/// another board of the cloud than the cameras before it becomes rejected. `range_offset_sigma_m`:
/// how well a constant that ranges may be off by is known; 0: exactly.
JointProblem MakeJointProblem(const Target& target, std::vector<GuessedCamera> cameras,
                              double range_offset_sigma_m);

/// A problem and where its solve starts.
struct BoardStart {
  BoardProblem problem;
  BoardState start;
};

/// The problem with some of the views only, to be solved from `state`.
BoardStart Part(const BoardProblem& problem, const std::vector<std::size_t>& views,
                const BoardState& state);

/// A joint solve of which views and sides that contradict the others were left out.
struct JointResult {
  JointProblem joint;  ///< what is left of it
  BoardSolution solution;
  double variance_factor = 1;  ///< by which the covariance was enlarged: views scatter more
  /// The range offset was held to less than the views say (see SolveJointly): what it was held to
  /// [m], 1 sigma. The problem's prior is wide then.
  std::optional<double> refuted_range_offset_sigma_m;
};

/// Solves; leaves out what contradicts the rest, worst first, at most a third of a camera's views,
/// and solves again. What is left out is gone from the problem, and rejected with its reason among
/// the cameras' views. A view's own estimate of a camera against that of all others: beyond
/// what chance does once in 20,000 views, it is out. A side's own shift beyond 4 of its sigmas: its
/// crossings are out, and a warning says so. Where the views put the range offset beyond 4 sigma
/// of what its prior allows, all is solved again with it free.
JointResult SolveJointly(JointProblem joint);

/// Of camera `index` [delta of rigid3.h], the variance factor counted in.
Matrix6d CovarianceOf(const JointResult& result, std::size_t index);

}  // namespace rgbdt
