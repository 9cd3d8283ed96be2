#include "services/drivers/lidar/internal/pcd_folder.h"

#include <algorithm>

#include "calib/files/name_keys.h"
#include "calib/files/points/cloud_files.h"
#include "calib/model/errors.h"
#include "calib/scan_assembly/sweep_chunks.h"
#include "services/posix/clock.h"
#include "services/runtime/pacer.h"

namespace rgbdt {
namespace fs = std::filesystem;

PcdFolder::PcdFolder(const PcdFolderDevice& device) : device_(device) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(device_.folder, error)) {
    if (entry.path().extension() == ".pcd") files_.push_back(entry.path());
  }
  if (error) {
    throw InputError(device_.folder + ": " + error.message() + "; expected a folder of PCD files");
  }
  if (files_.empty()) throw InputError(device_.folder + ": holds no *.pcd");
  std::sort(files_.begin(), files_.end());
}

std::optional<Cloud> PcdFolder::Read(DeviceThread& thread, const fs::path& file) {
  const Utime next =
      last_ == 0 ? HostUtime() : last_ + std::max<Utime>(1, FromSeconds(device_.period_s));
  try {
    Cloud cloud = ReadSweep(file, TimeInName(StemOf(file)).value_or(next));
    if (!cloud.utime.empty()) {
      cloud.sweep_utime = *std::min_element(cloud.utime.begin(), cloud.utime.end());
    }
    if (cloud.sweep_utime <= last_) {
      throw InputError(file.string() + ": its time " + std::to_string(cloud.sweep_utime) +
                       " us is not after that of the file before it");
    }
    return cloud;
  } catch (const std::exception& e) {
    report_.Count("bad files");
    thread.Warn(e.what());
    return std::nullopt;
  }
}

void PcdFolder::Serve(DeviceThread& thread) {
  Pacer pacer;
  for (std::size_t i = 0; i < files_.size() && !thread.Stopping(); ++i) {
    const std::optional<Cloud> cloud = Read(thread, files_[i]);
    if (!cloud) continue;
    last_ = cloud->sweep_utime;
    if (!thread.Sleep(pacer.WaitFor(last_, SteadyUtime()))) return;
    report_.SetSweepBegun(last_);
    report_.Set("file " + std::to_string(i + 1) + " of " + std::to_string(files_.size()) + " in " +
                    device_.folder,
                true);
    report_.Count("sweeps");
    for (CloudChunk& chunk : SplitSweep(*cloud)) thread.Publish(std::move(chunk));
  }
}

}  // namespace rgbdt
