#pragma once

#include <algorithm>
#include <chrono>
#include <optional>

#include "calib/model/time.h"
#include "services/runtime/device_thread.h"

namespace rgbdt {

/// Plays what was recorded at its own pace: the first time that it is told is now.
class Pacer {
 public:
  /// Sleeps until this recorded time has come; false: the thread is to stop.
  bool Wait(DeviceThread* thread, Utime utime) {
    using Clock = std::chrono::steady_clock;
    using Ms = std::chrono::milliseconds;
    if (!begin_) {
      begin_ = utime;
      wall_ = Clock::now();
    }
    const auto due = wall_ + std::chrono::microseconds(utime - *begin_);
    const auto left = std::chrono::duration_cast<Ms>(due - Clock::now()).count();
    if (left <= 0) return !thread->Stopping();
    constexpr std::int64_t kMostMs = 1'000'000'000;
    return thread->Sleep(static_cast<int>(std::min<std::int64_t>(left, kMostMs)));
  }

 private:
  std::optional<Utime> begin_;
  std::chrono::steady_clock::time_point wall_;
};

}  // namespace rgbdt
