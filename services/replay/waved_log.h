#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/sync/sync.h"

namespace rgbdt {

struct WavedLogOptions {
  double most_range_m = 8;  ///< what returned from farther away is not the board
  /// Of a longer log what comes later is not read.
  std::size_t most_sweeps = 600, most_images = 2400, most_points = 20'000'000;
  bool find_poses = false;  ///< of all cameras, though a calibration tells them
};

/// What a log holds of a waved board.
struct WavedLog {
  Rig rig;
  std::optional<Calibration> calibration;   ///< what the search began from
  std::optional<RangeErrors> range_errors;  ///< of that, by which the sweeps were corrected
  WavedBoard board;
  std::vector<std::string> problems;  ///< of what could not be used, a line each
};

/// Reads a log of lcm-logger with RIG, CLOUD of a spinning LIDAR and images, the board found in
/// each image. Sweeps are corrected by the calibration's range errors, unless `find_poses`. Poses
/// are those of `calibration`, or else of the log's CALIBRATION; where a camera has none, boards
/// are looked for in the sweeps, too. `progress`: how far, 0 to 1. Throws InputError where there is
/// no such log, it has no RIG or no sweep with times, or the LIDAR is a turned scanner, whose
/// sweeps last too long for a board that moves.
WavedLog ReadWavedLog(const std::string& log, const std::optional<Calibration>& calibration,
                      const WavedLogOptions& options = {},
                      const std::function<void(double)>& progress = {});

}  // namespace rgbdt
