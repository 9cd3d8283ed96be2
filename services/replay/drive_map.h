#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/session.h"
#include "calib/odometry/loop_closure.h"
#include "services/nodes/mapper_node.h"

namespace rgbdt {

/// What of a drive came out besides the map.
struct MappedDrive {
  std::vector<StampedPose> way;  ///< world_from_lidar over time, rising
  bool by_odometry = false;      ///< else by the log's POSE
  std::int64_t sweeps = 0;       ///< odometry: taken
  std::int64_t without_place = 0, degenerate = 0, restarts = 0;  ///< odometry: of these
  std::optional<ClosedWay> closed;                               ///< where loops were looked for
  std::int64_t clouds = 0, dropped = 0;
  std::int64_t unreadable_bytes = 0;  ///< of the log, that belong to no whole message
  std::string last_problem;
};

struct DriveOptions {
  /// Places that the way comes back to are looked for, and the way is corrected. It is that of the
  /// sweeps then: nothing says how well a log's POSE is known.
  bool close_loops = false;
  std::function<void(double)> progress;  ///< how far, 0 to 1
};

/// Maps a drive from a log of lcm-logger with CLOUD: its poses are those of POSE, or else those of
/// rgbdt-odometry from the sweeps; clouds are fused as rgbdt-fuser does where the log has RIG, by
/// its CALIBRATION and images if there are any, and go without colour elsewhere. The log is read
/// twice, so each point is placed by poses from before and after it. Throws InputError where there
/// is no such log, or no sweep in it whose place was found.
MappedDrive MapDrive(const std::string& log, MapperNode* mapper, const DriveOptions& options = {});

/// The way as TUM's RGB-D benchmark has it: a line a pose, time [s] tx ty tz qx qy qz qw.
std::string TumText(const std::vector<StampedPose>& way);

}  // namespace rgbdt
