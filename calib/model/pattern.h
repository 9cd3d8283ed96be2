#pragma once

#include "calib/model/rig.h"

namespace rgbdt {

/// A white board throws so much light back that the fringe of a beam's cone is enough for a return:
/// a recorded one (Ouster, 64 rings, 2.5 to 3.4 m) looks 24 to 29 mm too large at each side, 7 to
/// 11 mrad. This is the sigma of each class's shift (beam_priors.h) for boards without a pattern.
inline constexpr double kPlainClassShiftSigmaRad = 3e-3;

/// Whether a target has a checkerboard. A plain one is known by its outline alone; it has no inner
/// corners, and half a turn (a square: a quarter) cannot be told in one view.
inline bool HasPattern(const Target& target) { return target.squares_x > 0; }

}  // namespace rgbdt
