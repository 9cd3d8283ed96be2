#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/solve/internal/joint_solve.h"

namespace rgbdt {

/// The unknowns besides the poses that a joint solve found, as a person reads them, with sigma, the
/// variance factor counted in; without those of which the data say nothing.
/// Of the board, the reference LIDAR and camera `camera`'s lens.
std::vector<Nuisance> NuisancesOf(const JointResult& result, std::size_t camera);
/// Of a further LIDAR alone.
Estimate RangeOffsetOfLidar(const JointResult& result, std::size_t lidar);
std::vector<Nuisance> NuisancesOfLidar(const JointResult& result, std::size_t lidar);

/// The beam's unknown and the board's shape that lie the farthest beyond what such sensors and
/// boards do (beam_priors.h), as causes that something is not as it was given; without those of
/// which the data say nothing. A board that is bent far, but whose shape the views tell, moves
/// camera `camera`'s pose by little (Cause::moves_sigma).
/// Of sizes that were given there are better tests (given_wrong.h).
std::vector<Cause> BeyondPriors(const JointResult& result, std::size_t camera);

/// What the reference LIDAR is off by; nothing where it was taken for exact.
std::optional<RangeErrors> RangeErrorsOf(const JointResult& result);

}  // namespace rgbdt
