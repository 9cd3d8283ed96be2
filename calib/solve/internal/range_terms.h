#pragma once

#include "calib/solve/board_problem.h"

namespace rgbdt {

/// Fits what the problem takes ranges to be off by to what the views say at a solution: the scatter
/// of rings within a view, and, where the views are far likelier with them than without (chance
/// does as much once in 10,000 sessions), the offsets of single rings and of octaves of intensity
/// with their sigmas. Such terms become unknowns of the problem, at zero; none is taken away again.
/// Whether anything changed, so that it is to be solved again.
bool FitRangeTerms(const BoardSolution& solution, BoardProblem* problem, BoardState* state);

}  // namespace rgbdt
