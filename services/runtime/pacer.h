#pragma once

#include <algorithm>
#include <optional>

#include "calib/model/time.h"

namespace rgbdt {

/// Plays what was recorded or simulated at its own pace, or `speed` times as fast. The first time
/// asked for is now. A delay of more than kMaxLate is not caught up with: a burst would fill the
/// receivers' queues (lcm-logger's holds 30 messages).
class Pacer {
 public:
  static constexpr Utime kMaxLate = 20'000;

  explicit Pacer(double speed = 1) : speed_(speed) {}

  /// How long to wait [us] until `utime` has come; 0: it has. `now` is of any steady clock [us].
  Utime WaitFor(Utime utime, Utime now) {
    const Utime wait =
        start_ ? FromSeconds(ToSeconds(utime - start_->utime) / speed_) - (now - start_->now)
               : -kMaxLate - 1;
    if (wait < -kMaxLate) start_ = Start{utime, now};
    return std::max<Utime>(wait, 0);
  }

  /// The next time asked for is now.
  void Restart() { start_.reset(); }

 private:
  struct Start {
    Utime utime = 0, now = 0;
  };
  double speed_;
  std::optional<Start> start_;
};

}  // namespace rgbdt
