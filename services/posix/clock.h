#pragma once

#include <chrono>

#include "calib/model/time.h"

namespace rgbdt {

/// The machine's steady clock [us]; its zero is anywhere. How long something took is by this one:
/// the other is set while things go on.
inline Utime SteadyUtime() {
  using Microseconds = std::chrono::duration<Utime, std::micro>;
  return std::chrono::duration_cast<Microseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// The machine's wall clock [us, UTC], for stamps and for comparing them.
inline Utime HostUtime() {
  using Microseconds = std::chrono::duration<Utime, std::micro>;
  return std::chrono::duration_cast<Microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace rgbdt
