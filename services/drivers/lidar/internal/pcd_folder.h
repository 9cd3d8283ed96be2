#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "calib/model/devices.h"
#include "services/drivers/device_report.h"
#include "services/runtime/device_thread.h"

namespace rgbdt {

/// A folder of PCD files, in the order of their names -> CLOUD, one sweep a file, at the pace of
/// their times. A sweep's time is that of its first point, where the points have times (ReadSweep);
/// else what the file's name tells (TimeInName); else period_s after the one before, the first
/// one's being the host's. A file that cannot be read, or whose time is not after the one before,
/// is named and passed over.
class PcdFolder {
 public:
  /// Throws InputError where there is no such folder, or no *.pcd in it.
  explicit PcdFolder(const PcdFolderDevice& device);

  /// Until the last file, or the thread stops.
  void Serve(DeviceThread& thread);
  const DeviceReport& report() const { return report_; }

 private:
  std::optional<Cloud> Read(DeviceThread& thread, const std::filesystem::path& file);

  PcdFolderDevice device_;
  DeviceReport report_;
  std::vector<std::filesystem::path> files_;
  Utime last_ = 0;  // sweep's time; 0: none yet
};

}  // namespace rgbdt
