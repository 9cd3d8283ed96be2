#pragma once

#include <cmath>

#include "calib/model/time.h"

namespace rgbdt {

// What many tests measure in, and the times that they begin at.
inline constexpr double kDegree = M_PI / 180;              ///< [rad]
inline constexpr Utime kSecond = kMicrosecondsPerSecond;   ///< [us]
inline constexpr Utime kNow = 1'500'000'000'000'000;       ///< of 2017 [us]
inline constexpr Utime kSweep = kNow;                      ///< the first sweep's time [us]
inline constexpr Utime kJune2015 = 1'433'160'000'000'000;  ///< its first noon [us]

}  // namespace rgbdt
