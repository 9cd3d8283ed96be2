#pragma once

#include <cstddef>

#include "calib/solve/board_problem.h"

namespace rgbdt {

/// The same problem and state in the frame of a further LIDAR, which takes the reference's place,
/// and the reference its own: what is worked out of the reference's clouds is worked out of any
/// LIDAR's. Twice is back again.
void SwapReference(std::size_t lidar, BoardProblem* problem, BoardState* state);

}  // namespace rgbdt
