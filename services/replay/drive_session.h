#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "calib/model/time.h"

namespace rgbdt {

struct CutOptions {
  Utime every = 2 * kMicrosecondsPerSecond;  ///< of the sweeps, one in this time is taken
  std::size_t most_sweeps = 60;  ///< of a longer drive so many at most, evenly: every is doubled
};

/// What was cut out of a log.
struct CutDrive {
  std::size_t sweeps = 0, views = 0;
  bool by_odometry = false;  ///< the log has no POSE: motion is taken out by that of the sweeps
  /// Neither POSE nor the sweeps tell how the rig moved: it was taken to stand. (As that of a
  /// turned scanner is, for each sweep.)
  bool motion_unknown = false;
  std::vector<std::string> problems;  ///< of what could not be used, a line each
};

/// Cuts a log of lcm-logger of a drive, without captures, into a session directory: rig.textproto,
/// calibration.textproto where the log has one, and for each camera and sweep that is taken a view
/// "0001-rgb", the sweep as seen from where the rig was when the image was taken
/// (nodes/shot_collector.h). Where that was is told by POSE or, in a log without, of a spinning
/// LIDAR, by the sweeps (nodes/odometry_node.h); where neither tells, the rig is taken to stand.
/// Every third sweep is held out. Lines of a turned scanner are put together as rgbdt-assembler
/// does. `dir` is new or empty. `progress`: how far, 0 to 1. Throws InputError where there is no
/// such log, it has no RIG, or no sweep with an image of its time.
CutDrive CutIntoSession(const std::string& log, const std::filesystem::path& dir,
                        const CutOptions& options = {},
                        const std::function<void(double)>& progress = {});

}  // namespace rgbdt
