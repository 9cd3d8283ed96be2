#pragma once

#include "calib/model/time.h"

namespace rgbdt {

/// What is done at once and then once a period [us]. After a pause longer than a period it goes on
/// from there: what was missed is not made up for.
class Periodic {
 public:
  explicit Periodic(Utime period) : period_(period) {}

  bool IsDue(Utime now) {
    if (begun_ && now < next_) return false;
    const bool missed = !begun_ || now - next_ >= period_;
    next_ = (missed ? now : next_) + period_;
    begun_ = true;
    return true;
  }

 private:
  Utime period_;
  bool begun_ = false;
  Utime next_ = 0;
};

}  // namespace rgbdt
