#pragma once

#include <vector>

#include "calib/model/shot.h"

namespace rgbdt {

/// Where the LIDAR was for each of these sweeps, as they tell themselves (Odometry::FindStops): in
/// the order in which the rig came by, up to 2.4 m from one to the next. One that fits nowhere is
/// in a world of its own.
std::vector<ShotPlace> FindPlaces(const std::vector<const Cloud*>& sweeps);

}  // namespace rgbdt
