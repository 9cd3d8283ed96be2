#pragma once

#include <cstdint>
#include <functional>

#include "calib/model/rigid3.h"

namespace rgbdt::simulate {

/// A LIDAR's way through a scene: world_from_lidar at a time [s]. The world's z is up, its origin
/// at the LIDAR's height.
using Way = std::function<Rigid3(double seconds)>;

/// Along x at about this speed [m/s], which changes by a fifth, `aside_m` to and fro across, over
/// streets of planes, over which the rig nods: smooth, and at no time of constant velocity.
/// `at_rest_s`: stands before.
Way StreetWay(std::uint64_t seed, double speed_mps, double aside_m = 0.7, double at_rest_s = 0);
/// Round the free middle of the room, looking about.
Way RoomWay(std::uint64_t seed, double speed_mps);

}  // namespace rgbdt::simulate
