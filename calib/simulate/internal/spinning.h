#pragma once

#include <cstdint>

#include "calib/model/cloud.h"
#include "calib/simulate/internal/world.h"
#include "calib/simulate/lidar_options.h"

namespace rgbdt::simulate {

/// One revolution of a spinning LIDAR: an organised cloud, ring x azimuth (lines are rings, the
/// lowest first; beams are azimuths, from `first_azimuth_rad` on). A miss is NaN and keeps its
/// direction. Noise is a function of (seed, utime) only, a ring's bias of the seed. `threads` 0: as
/// many as the machine has, the result is the same. The LIDAR stands where `world_from_lidar` puts
/// it; the cloud is in its own frame.
Cloud SpinningSweep(const World& world, const SpinningOptions& options, std::uint64_t seed,
                    Utime utime, int threads = 0, const Rigid3& world_from_lidar = {});

/// The constant bias [m] of a ring's ranges.
double RingBias(const SpinningOptions& options, std::uint64_t seed, int ring);

}  // namespace rgbdt::simulate
