#pragma once

#include <chrono>

#include "calib/model/time.h"

namespace rgbdt::viewer {

/// The machine's steady clock [s].
inline double SteadySeconds() {
  using Seconds = std::chrono::duration<double>;
  return std::chrono::duration_cast<Seconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// The machine's wall clock [us, UTC].
inline Utime WallUtime() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace rgbdt::viewer
