#pragma once

#include "calib/simulate/internal/things.h"
#include "calib/simulate/options.h"

namespace rgbdt::simulate {

/// The rig drives where |y| is less than this [m]; nothing stands there.
inline constexpr double kStreetFree = 1.3;

/// A street along x, laid out cell by cell as seed and cell draw, so that it has no end: what lies
/// about `x_m`. World frame: z up, the LIDAR's height zero.
Thing MakeStreet(const Options& options, const Warmth& warmth, double x_m);

}  // namespace rgbdt::simulate
