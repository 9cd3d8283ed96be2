#pragma once

#include "calib/simulate/internal/things.h"

namespace rgbdt::simulate {

/// A person in mid-step who walks along x; clothes, height and stance are drawn. Clothing has
/// `temperature_k`, skin is 1 K warmer.
Thing MakeWalker(Dice* draw, double temperature_k);

}  // namespace rgbdt::simulate
