#pragma once

#include "calib/model/rigid3.h"
#include "calib/simulate/options.h"

namespace rgbdt::simulate {

/// world_from_lidar of a natural scene's view, a function of (seed, index): the rig drives along x,
/// outdoors without end, indoors to and fro in the free middle of the room.
Rigid3 WorldFromLidar(const Options& options, int index);

}  // namespace rgbdt::simulate
