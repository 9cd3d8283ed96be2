#pragma once

#include "calib/simulate/internal/things.h"

namespace rgbdt::simulate {

/// A house whose facade is y = 0 and x from 0 to `width_m`, seen from -y: window recesses, door,
/// balconies, ledges, a poster.
Thing MakeHouse(Dice* draw, const Warmth& warmth, double width_m);

}  // namespace rgbdt::simulate
