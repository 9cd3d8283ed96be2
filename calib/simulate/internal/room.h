#pragma once

#include "calib/simulate/internal/things.h"
#include "calib/simulate/options.h"

namespace rgbdt::simulate {

/// The rig moves where |x| and |y| are less than this [m]; nothing stands there.
inline constexpr double kRoomFree = 1.2;

/// A room with furniture as the seed draws it, and its lamps. World frame: z up, the LIDAR's height
/// zero.
Thing MakeRoom(const Options& options, const Warmth& warmth, std::vector<Light>* lights);

}  // namespace rgbdt::simulate
