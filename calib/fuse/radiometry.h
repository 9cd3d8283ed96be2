#pragma once

#include "calib/model/image.h"

namespace rgbdt {

/// Temperature [K] of the surface that gave these counts; NaN where the radiometry has no answer.
/// With emissivity e < 1 and a known reflected temperature, what is mirrored is taken off:
///   linear: T_apparent^4 = e T^4 + (1 - e) T_reflected^4 (Stefan-Boltzmann, grey surface), since
///     such counts say nothing of the camera's band;
///   Planck: on counts, which are radiance within that band: S - O = e W(T) + (1 - e)
///   W(T_reflected)
///     with W(T) = R / (exp(B / T) - F).
double KelvinOf(const Radiometry& radiometry, double counts);

}  // namespace rgbdt
