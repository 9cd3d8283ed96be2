#pragma once

#include <Eigen/Core>

#include "calib/solve/board_problem.h"

namespace rgbdt {

/// SolveBoards' problem as Ceres has it, about a state, with Ceres' automatic derivatives. The lens
/// is the library's own template (lens.h). The other residuals are written here again, from the
/// formulas in board_problem.h: the solver's code computes values and derivatives in one pass over
/// double, and a formula that is wrong in the solver does not stand on both sides.

/// The optimum, its deltas about where it is.
BoardState SolveByCeres(const BoardProblem& problem, const BoardState& start);

/// Of all residuals, robust weights counted in, by all unknowns: the shared ones, as in
/// board_model.h, then each view's, as in view_equations.h.
Eigen::MatrixXd JacobianByCeres(const BoardProblem& problem, const BoardState& state);

}  // namespace rgbdt
