#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "calib/model/cloud.h"
#include "calib/simulate/internal/world.h"
#include "calib/simulate/lidar_options.h"

namespace rgbdt::simulate {

/// Where a laser (0 to LivoxLasers - 1) looks at a time [s]: a unit vector in the LIDAR frame.
///
/// Avia: two wedges that turn against each other, by the first-order sum of their deflections
/// (Marshall, "Risley prism scan patterns", 1999), at the rates that Brazeal et al. (Sensors 2021,
/// 21, 4722) found in a Mid-40, 7294 and -4664 turns a minute: a rosette that comes round after
/// 30 s. It fills a circle of 70.4 degrees; six lasers one above the other make it 77.2 degrees
/// high, as the data sheet has it. The Avia's own rates are not published.
///
/// Mid-360: a mirror turns while it nods, so each of four lasers draws a helix between -7 and 52
/// degrees; as many turns as make the 40 lines in 0.1 s that the vendor compares it with. Rates and
/// the lasers' angles are assumed: the vendor publishes no formula.
Eigen::Vector3d LivoxDirection(LivoxModel model, double time_s, int laser);
int LivoxLasers(LivoxModel model);

/// Whether a point lies in the field, this far from its limits.
bool InLivoxField(LivoxModel model, const Eigen::Vector3d& point, double margin_rad);

/// What it sees from `utime` on, for options.seconds: hits in the order in which they were
/// measured, not organised, without rings. The pattern goes on from one call to the next with
/// `utime`. Noise is a function of (seed, utime) only. `threads` 0: as many as the machine has, the
/// result is the same.
Cloud LivoxCloud(const World& world, const LivoxOptions& options, std::uint64_t seed, Utime utime,
                 int threads = 0);

}  // namespace rgbdt::simulate
