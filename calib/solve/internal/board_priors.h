#pragma once

#include "calib/solve/board_problem.h"

namespace rgbdt {

/// What the priors of the shared unknowns cost at a state: whitened, squared. How they change with
/// the unknowns is PriorInformation (board_problem.h).
double PriorCost(const BoardProblem& problem, const BoardState& state);

}  // namespace rgbdt
