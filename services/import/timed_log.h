#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "services/bus/log_writer.h"
#include "services/messages/codec.h"

namespace rgbdt {

/// A log of messages in the order in which they are heard, whenever they are added; each is
/// numbered, channel by channel. It has its name once it is closed (LogWriter). Throws InputError
/// where a message cannot be encoded or written.
class TimedLog {
 public:
  explicit TimedLog(const std::filesystem::path& path) : log_(path.string()) {}

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
  }

 private:
  void WriteFirst() {
    const auto first = waiting_.begin();
    log_.Write(first->second.first, first->second.second, first->first);
    waiting_.erase(first);
  }

  LogWriter log_;
  std::map<std::string, std::int64_t> seq_;
  std::multimap<Utime, std::pair<std::string, Bytes>> waiting_;
};

}  // namespace rgbdt
