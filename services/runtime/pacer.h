#pragma once

#include <algorithm>

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
    Utime wait = FromSeconds(ToSeconds(utime - start_utime_) / speed_) - (now - start_now_);
    if (!started_ || wait < -kMaxLate) {
      started_ = true;
      start_utime_ = utime;
      start_now_ = now;
      wait = 0;
    }
    return std::max<Utime>(wait, 0);
  }

  /// The next time asked for is now.
  void Restart() { started_ = false; }

 private:
  double speed_;
  bool started_ = false;
  Utime start_utime_ = 0, start_now_ = 0;
};

}  // namespace rgbdt
