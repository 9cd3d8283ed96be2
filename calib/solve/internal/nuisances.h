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

/// The beam's or the board's unknown that lies the farthest beyond what such sensors and boards do
/// (beam_priors.h), as a cause that something is not as it was given; nothing where none is told.
/// Of sizes that were given there are better tests (given_wrong.h).
std::optional<Cause> FarthestBeyondPriors(const JointResult& result);

/// What the reference LIDAR is off by; nothing where it was taken for exact.
std::optional<RangeErrors> RangeErrorsOf(const JointResult& result);

}  // namespace rgbdt
