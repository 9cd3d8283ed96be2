#pragma once

#include <optional>

#include "calib/odometry/internal/moving_sweep.h"
#include "calib/odometry/internal/plane_map.h"
#include "calib/odometry/internal/registration.h"

namespace rgbdt::odometry {

/// What is known of a rig that stood, and went on to its next stop, `lost` stops having been missed
/// in between.
Motion AfterStop(Motion motion, int lost);

/// What is known of a rig that drives on from where it was, as fast as it was; one that stood may
/// set off.
Motion SetOff(Motion motion);

/// Where it stands now.
struct Stop {
  Registration best;
  std::optional<Rigid3> other;  ///< world_from_lidar of another place that the sweep fits as well
};

/// Of a rig that is upright as before (AfterStop). A grid of places and headings is looked through,
/// each by how near a few hundred of the sweep's points come to the map's planes (correlative
/// matching: Olson, ICRA 2009); from the likeliest of them, neighbours left out, the sweep is
/// registered, and the place at which most points lie near a plane is the right one.
Stop FindStop(const TimedSweep& sweep, const PlaneMap& map, const Motion& before, int lost,
              const OdometryOptions& options);

}  // namespace rgbdt::odometry
