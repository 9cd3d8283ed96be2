#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "calib/model/calibration.h"
#include "calib/model/rig.h"
#include "services/import/import_bag.h"

namespace rgbdt {

/// A calibrated rig, as the log is to have it.
struct LogRig {
  Rig rig;  ///< with `text` and `hash`, as it was read
  std::optional<Calibration> calibration;
};

struct WrittenLog {
  std::int64_t clouds = 0, images = 0;
  std::int64_t untimed = 0;      ///< clouds whose points had no times that could be a sweep's
  std::int64_t other_clock = 0;  ///< clouds whose points had the times of another clock
  std::int64_t unreadable = 0;   ///< of either
  std::string last_problem;      ///< of those
};

/// A bag's clouds (CLOUD) and the images of those of its cameras that the rig has (<CAMERA>_IMAGE),
/// each at the time at which the last of it was measured, as a log of lcm-logger; RIG and
/// CALIBRATION once a second. Without a rig: clouds alone. Of a Livox, the clouds of each second
/// are one. Points' times of another clock than their header's are moved, so that the first is the
/// header's. Raw images stay raw as far as they fit the bus, compressed ones are compressed again.
/// Messages are read in the order of time, each once, and no more of them are held than come while
/// a cloud is measured. The file is there once all of it is. `progress` gets 0 to 1. Throws
/// InputError where nothing can be read, of a camera of the rig nothing that is its, and where the
/// log cannot be written.
WrittenLog WriteLog(BagReader* bag, const TopicChoice& choice, const std::optional<LogRig>& rig,
                    const CloudReader& read_cloud, const std::filesystem::path& path,
                    const std::function<void(double)>& progress);

}  // namespace rgbdt
