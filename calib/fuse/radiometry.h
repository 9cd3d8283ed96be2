#pragma once

#include "calib/model/image.h"

namespace rgbdt {

/// Temperature [K] of the surface that gave these counts; NaN where the radiometry has no answer.
/// With emissivity e < 1 and a known reflected temperature, what is mirrored is taken off:
/// T_apparent^4 = e T^4 + (1 - e) T_reflected^4 (Stefan-Boltzmann, grey surface).
double KelvinOf(const Radiometry& radiometry, double counts);

}  // namespace rgbdt
