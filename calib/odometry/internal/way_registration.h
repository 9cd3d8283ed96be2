#pragma once

#include <vector>

#include "calib/odometry/internal/moving_sweep.h"
#include "calib/odometry/internal/plane_map.h"
#include "calib/odometry/internal/registration.h"

namespace rgbdt::odometry {

/// The way that a rig drove during a sweep.
struct WayRegistration {
  std::vector<Motion> parts;  ///< in the middle of each
  std::size_t selected = 0;   ///< points, of all parts
  /// Of half a second, the worst: share of its points that lie near a plane (Registration::near).
  double worst_near = 0;
  /// By the parts up to each, not by those behind it: what the next sweep may begin from.
  std::vector<Matrix12d> so_far;
  Registration whole;  ///< motion: the last part's; degenerate: in the middle part's axes
};

/// The way that puts all parts' points on the map's planes: a continuous trajectory whose
/// acceleration is white (Predict; Barfoot, Tong and Sarkka 2014), solved for all parts together by
/// Gauss and Newton. It begins at `before`, of the time `before_utime`, and grows part by part, so
/// that points find their planes. `parts` is not empty.
///
/// A few lines of a scanner do not tell all of a part's motion, and planes that are tilted by
/// chance seem to tell the rest: whichever way a point goes, it finds a voxel in whose plane it
/// lies. So points count as scattering by `scatter_m`, much more than they do: what all of them
/// tell is still known to millimetres, what chance seems to tell is less than how the motion goes
/// on.
WayRegistration RegisterWay(const std::vector<TimedSweep>& parts, const PlaneMap& map,
                            const Motion& before, Utime before_utime, double scatter_m,
                            const OdometryOptions& options);

}  // namespace rgbdt::odometry
