#pragma once

#include <vector>

#include "calib/model/shot.h"

namespace rgbdt {

/// Sets where the LIDAR was for each shot, as their sweeps tell (Odometry::FindStops): in the order
/// in which the rig came by, up to 2.4 m from one to the next. One that fits nowhere is in a world
/// of its own.
void FindPlaces(std::vector<Shot>* shots);

}  // namespace rgbdt
