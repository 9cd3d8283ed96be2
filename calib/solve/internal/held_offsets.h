#pragma once

#include <vector>

#include "calib/solve/internal/joint_solve.h"

namespace rgbdt {

/// Range offsets that are held closer than is usual. The reference's by a plain board is no
/// unknown.
std::vector<RefutedOffset> HeldOffsets(const BoardProblem& problem);

/// Those of them that the views put beyond so many sigmas.
std::vector<RefutedOffset> RefutedOf(const std::vector<RefutedOffset>& held,
                                     const JointResult& result, double sigmas);

/// It becomes as unknown as it is usual.
void FreeOffset(const RefutedOffset& offset, BoardProblem* problem);

}  // namespace rgbdt
