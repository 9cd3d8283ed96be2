#pragma once

#include <cstdint>

#include "calib/model/cloud.h"
#include "calib/model/rig.h"

namespace rgbdt::bench {

/// A board in an empty room, as a LIDAR in the room would see it: some `points` beams, evenly
/// spread over 60 degrees to the sides and 80 up and down, organised, each a range with 10 mm of
/// noise. No beam width, no reflectivity: for times, not for errors. Quick at any size.
Cloud AnalyticCloud(const Target& target, const Rigid3& lidar_from_target, int points,
                    std::uint64_t seed);

/// A place where the board stands wholly in that field, 2 to 5 m away, tilted and turned.
Rigid3 DrawBoard(std::uint64_t seed, int index);

}  // namespace rgbdt::bench
