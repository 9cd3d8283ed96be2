#pragma once

#include <cstdint>
#include <functional>

#include "calib/model/cloud.h"
#include "calib/model/rigid3.h"
#include "calib/simulate/internal/world.h"
#include "calib/simulate/lidar_options.h"

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

/// A sweep of a spinning LIDAR that moves while it turns: each column of beams starts from where
/// the LIDAR is at its time. Ring x azimuth, each point with its time, as the LIDAR saw it then.
Cloud MovingSweep(const World& world, const SpinningOptions& lidar, std::uint64_t seed, Utime utime,
                  const std::function<Rigid3(Utime)>& world_from_lidar);

}  // namespace rgbdt::simulate
