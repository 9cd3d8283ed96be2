#pragma once

#include <optional>

#include "calib/model/time.h"

namespace rgbdt {

/// What is done at once and then once a period [us]. After a pause longer than a period it goes on
/// from there: what was missed is not made up for.
class Periodic {
 public:
  explicit Periodic(Utime period) : period_(period) {}

  bool IsDue(Utime now) {
    if (next_ && now < *next_) return false;
    const bool missed = !next_ || now - *next_ >= period_;
    next_ = (missed ? now : *next_) + period_;
    return true;
  }

 private:
  Utime period_;
  std::optional<Utime> next_;
};

}  // namespace rgbdt
