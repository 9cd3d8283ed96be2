#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "calib/model/session.h"
#include "calib/model/time.h"

namespace rgbdt {

/// What a device's thread reports for the status of its process.
class DeviceReport {
 public:
  /// What it does or waits for, and whether it is of use.
  void Set(const std::string& text, bool ready) {
    const std::lock_guard<std::mutex> lock(mutex_);
    text_ = text;
    ready_ = ready;
  }
  /// Counters appear in the order in which they were first counted.
  void Count(const std::string& counter, std::int64_t by = 1) {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (auto& [name, value] : counters_) {
      if (name == counter) {
        value += by;
        return;
      }
    }
    counters_.emplace_back(counter, by);
  }
  /// The newest sweep has begun: its name.
  void SetSweepBegun(Utime sweep_utime) {
    const std::lock_guard<std::mutex> lock(mutex_);
    sweep_begun_ = sweep_utime;
  }
  /// 0: none yet.
  Utime sweep_begun() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return sweep_begun_;
  }
  std::int64_t count(const std::string& counter) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const auto& [name, value] : counters_) {
      if (name == counter) return value;
    }
    return 0;
  }
  Status GetStatus() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    Status status;
    status.ready = ready_;
    status.text = text_;
    status.counters = counters_;
    return status;
  }

 private:
  mutable std::mutex mutex_;
  bool ready_ = false;
  std::string text_ = "starts";
  std::vector<std::pair<std::string, std::int64_t>> counters_;
  Utime sweep_begun_ = 0;
};

}  // namespace rgbdt
