#pragma once

#include "calib/model/rig.h"
#include "calib/simulate/options.h"

namespace rgbdt::simulate {

/// Gives the board the pattern, markers, holes and size of `target`; what it is made of, and how
/// warm it is, stays.
void UseTarget(const Target& target, BoardOptions* board);

}  // namespace rgbdt::simulate
