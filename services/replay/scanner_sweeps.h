#pragma once

#include <string>
#include <vector>

#include "calib/model/rig.h"
#include "calib/scan_assembly/turned_beams.h"

namespace rgbdt {

/// What the turned scanner measured, and the rig that the clouds were made with.
struct ScannerSweeps {
  Rig rig;
  std::vector<std::string> names;  ///< of views, or the sweeps' start [us]
  std::vector<TurnedBeams> sweeps;
  std::vector<std::string> problems;  ///< of what could not be used, a line each
};

/// From a session directory, whose clouds are taken apart, or from a log of lcm-logger with RIG,
/// LINE_SCAN and ENCODER. Throws InputError, also where the rig has no turned scanner or nothing
/// could be used.
ScannerSweeps ReadScannerSweeps(const std::string& dir_or_log);

}  // namespace rgbdt
