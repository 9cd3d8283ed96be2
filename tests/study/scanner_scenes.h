#pragma once

#include <cstdint>

#include "calib/model/rigid3.h"
#include "calib/scan_assembly/scanner_geometry.h"
#include "calib/simulate/options.h"

namespace rgbdt::study {

/// How far off the guess is, about and along each of the motor's axes (the sign is drawn).
struct ScannerError {
  double lever_m = 0.005;
  double tilt_rad = 0.5 * simulate::kDegree;
};

/// A sweep of the synthetic room by a scanner of random lever arm and tilt, assembled with a wrong
/// geometry, and taken apart again.
struct ScannerCase {
  TurnedScanner truth, guess;
  TurnedBeams beams;
};

/// Sensor and room by rays (calib/simulate), encoder in whole ticks. The same seed gives the same.
ScannerCase MakeScannerCase(std::uint64_t seed, const ScannerError& error,
                            const simulate::ScannerOptions& scanner);

/// truth = Exp(delta) * estimate in what a sweep can tell: (rx, ry [rad], tx, ty [m]). A turn about
/// the motor's axis and a shift along it are taken out first.
Eigen::Vector4d ScannerErrorOf(const Rigid3& truth, const Rigid3& estimate);

/// The covariance of ScannerErrorOf.
Eigen::Matrix4d ObservableCovariance(const ScannerGeometry& geometry);

}  // namespace rgbdt::study
