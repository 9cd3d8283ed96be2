#pragma once

#include <vector>

#include "calib/solve/board_problem.h"

namespace rgbdt {

/// The joint solve's objective (board_problem.h) as a function of the cameras' poses alone, for
/// pictures of it and for judging poses far from any solution: each view's board stands where the
/// camera's image and `camera_from_lidar` put it, told by the end that is nearer to the cloud's,
/// and what the cloud says against that is added up: the crossings' distances from its sides and
/// its points' distances from its plane, whitened, robust. What does not depend on where a camera
/// is (corners, sides in the image, priors) is left out. `shared_state`: shifts of sides, classes
/// and outline; its poses are not looked at. A board seen by two cameras counts twice.
///
/// Finite everywhere: no residual counts more than one of 10,000 sigmas, and beams that would not
/// meet the board at all count as much. A view's points count as one residual, their root mean
/// square, so many times.
double BoardObjective(const BoardProblem& problem, const BoardState& shared_state,
                      const std::vector<Rigid3>& camera_from_lidar);

}  // namespace rgbdt
