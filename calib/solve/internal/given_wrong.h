#pragma once

#include <vector>

#include "calib/model/calibration.h"
#include "calib/solve/internal/joint_solve.h"

namespace rgbdt {

/// What may have been given wrong to a solve, as each camera's report has it, the likeliest first:
/// its lens, and those of other cameras that are surely off; the squares; the board's size and its
/// pattern's place; the cloud's scale.
///
/// Score tests (Rao 1948) at the solution: no unknown is added, and nothing is solved again. With D
/// the views' information about the shared unknowns, d their gradient, C the covariance with the
/// priors counted in, p the priors' gradient: had a quantity been given wrong by theta along V (in
/// the unknowns' own units), the views ask for
/// theta = I^-1 (V' d - V' D C (d + p)), I = V' D V - V' D C D V,
/// with the covariance I^-1 times the variance factor, in which the priors' own variance along V
/// is. How far the pose then moves is -C D V theta. To it comes what a careful person leaves: 0.2%
/// of a square, 3 mm of a board's side.
///
/// Where a lens was refuted, the solution has the one that the views found: its differences from
/// the given one stand in the lens's place.
std::vector<std::vector<Cause>> GivenWrong(const JointResult& result);

}  // namespace rgbdt
