#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "calib/files/atomic_file.h"
#include "services/bus/log_writer.h"
#include "services/messages/codec.h"

namespace rgbdt {

/// A log of messages in the order in which they are heard, whenever they are added; each is
/// numbered, channel by channel. It has its name once it is closed, and lies beside until then, as
/// NAME.part. Throws InputError where a message cannot be encoded or written.
class TimedLog {
 public:
  explicit TimedLog(std::filesystem::path path)
      : path_(std::move(path)), part_(PartOf(path_)), log_(part_) {}
  ~TimedLog() {
    std::error_code ignored;
    std::filesystem::remove(part_, ignored);
  }
  TimedLog(const TimedLog&) = delete;
  TimedLog& operator=(const TimedLog&) = delete;

  void Add(Message message, Utime heard) {
    const std::string channel = ChannelOf(message);
    SetSeq(seq_[channel]++, &message);
    waiting_.emplace(heard, std::pair(channel, Encode(message)));
  }
  /// RIG, and a CALIBRATION for each of its cameras.
  void AddRig(const Rig& rig, const std::optional<Calibration>& calibration, Utime heard) {
    Add(RigText{0, rig.hash, rig.text}, heard);
    if (!calibration) return;
    for (const CameraCalibration& camera : calibration->cameras) {
      Add(CalibrationMessage{0, calibration->utime, rig.hash, calibration->method, camera}, heard);
    }
  }
  /// Nothing comes any more that was heard before this.
  void WriteUntil(Utime utime) {
    while (!waiting_.empty() && waiting_.begin()->first <= utime) WriteFirst();
  }
  void Close() {
    while (!waiting_.empty()) WriteFirst();
    log_.Close();
    Rename(part_, path_);
  }

 private:
  static std::string PartOf(const std::filesystem::path& path) {
    std::error_code ignored;  // what cannot be made is told where it is opened
    if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), ignored);
    return path.string() + ".part";
  }
  void WriteFirst() {
    const auto first = waiting_.begin();
    log_.Write(first->second.first, first->second.second, first->first);
    waiting_.erase(first);
  }

  std::filesystem::path path_;
  std::string part_;
  LogWriter log_;
  std::map<std::string, std::int64_t> seq_;
  std::multimap<Utime, std::pair<std::string, Bytes>> waiting_;
};

}  // namespace rgbdt
