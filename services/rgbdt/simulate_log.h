#pragma once

#include <filesystem>

#include "calib/simulate/options.h"

namespace rgbdt {

/// A log of a board that is waved before the rig, for `rgbdt sync`: wave.lcmlog in `dir`, with
/// rig.textproto and truth.textproto, which says what each clock is off by.
void SimulateWave(const std::filesystem::path& dir, const simulate::Options& options,
                  double seconds);

enum class Clocks { kExact, kOff };

/// A log of a rig that drives, for `rgbdt map` and `rgbdt refine`: drive.lcmlog in `dir`, with
/// rig.textproto, truth.textproto, truth.tum (where it was) and calibration.textproto (the truth,
/// which the log has, too). Clocks::kOff: cameras' clocks and shutters as DrawClocks has them,
/// which the calibration knows.
void SimulateDrive(const std::filesystem::path& dir, const simulate::Options& options,
                   double seconds, Clocks of_cameras);

}  // namespace rgbdt
