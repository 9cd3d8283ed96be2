#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>

#include "services/messages/message.h"
#include "services/replay/wave_reader.h"

namespace rgbdt {

/// A calibration of the messages of a bus, the newest of each camera; absent: there were none.
std::optional<Calibration> CalibrationOf(const std::map<std::string, CalibrationMessage>& cameras);

/// Reads a log of lcm-logger with RIG, CLOUD of a spinning LIDAR and images by a WaveReader. Poses
/// are those of `calibration`, or else of the log's CALIBRATION. `progress`: how far, 0 to 1.
/// Throws InputError where there is no such log, it has no RIG or no sweep with times, or the rig
/// is one to which a waved board tells nothing.
WavedLog ReadWavedLog(const std::string& path, const std::optional<Calibration>& calibration,
                      const WavedLogOptions& options = {},
                      const std::function<void(double)>& progress = {});

}  // namespace rgbdt
