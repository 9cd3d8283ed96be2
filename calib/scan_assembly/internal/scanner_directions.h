#pragma once

// Inside calib/scan_assembly only: which of the seven unknowns a sweep tells, in words.

#include <vector>

#include "calib/scan_assembly/internal/beam_planes.h"
#include "calib/scan_assembly/scanner_geometry.h"

namespace rgbdt {

/// What no sweep sees, whatever the room: a turn about the motor's axis, a shift along it, and the
/// encoder's zero. Each moves all points of a sweep as one rigid body.
constexpr bool IsGauge(int direction) { return direction == 2 || direction == 5 || direction == 6; }

/// Sigmas of the guess, in the order of Vector7d.
Vector7d PriorOf(const ScannerGeometryOptions& options);

/// (information + prior^-2)^-1; no information comes from the gauges' rounding errors.
Matrix7d CovarianceOf(const Matrix7d& information, const Vector7d& prior);

/// `covariance` beside the prior. `change`: from the guess.
std::vector<ScannerDirection> DirectionsOf(const Matrix7d& covariance, const Vector7d& change,
                                           const ScannerGeometryOptions& options,
                                           double seen_twice);

}  // namespace rgbdt
