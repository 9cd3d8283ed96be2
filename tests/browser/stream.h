#pragma once

#include <cstdint>
#include <limits>

namespace rgbdt::browser {

struct StreamOptions {
  double sweeps_hz = 5;
  std::int64_t points = 100'000;  ///< of a sweep
  int chunks = 10;                ///< of a sweep: CLOUD messages, spread over it
  double images_hz = 5;           ///< of each camera; 0: none
  double seconds = std::numeric_limits<double>::infinity();
};

/// Publishes on LCM_DEFAULT_URL what a calibrated rig would, in real time and with the wall clock's
/// utimes, so that latencies can be read from them: CLOUD in chunks, both cameras' images, RIG and
/// CALIBRATION each second. Clouds and images were made beforehand. Ends after `seconds` or when it
/// is killed.
void Stream(const StreamOptions& options);

}  // namespace rgbdt::browser
