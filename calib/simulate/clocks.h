#pragma once

#include <string>
#include <vector>

#include "calib/simulate/options.h"

namespace rgbdt::simulate {

/// What a camera's shutter and clock do. An image whose middle row shows what was at time t by the
/// LIDAR's clock has utime t - OffsetAt(t).
struct ClockOptions {
  double offset_s = 0;
  double drift = 0;                  ///< [s/s], since the recording began
  double jump_s = 0, jump_at_s = 0;  ///< what the offset grows by, and when
  double rolling_s = 0;  ///< from the first row's exposure to the last one's; below 0: from below

  /// When a row is exposed, after the middle one [s].
  double RowAfterMiddle(double row, int height) const {
    return rolling_s * (row / (height - 1) - 0.5);
  }
  double OffsetAt(double seconds) const {
    return offset_s + drift * seconds + (jump_s != 0 && seconds >= jump_at_s ? jump_s : 0);
  }
};

/// What real clocks and shutters are off by, one a camera, drawn from the seed: offsets of up to
/// 0.1 s, drifts of up to 2e-5, in colour a shutter that rolls for 10 to 25 ms.
std::vector<ClockOptions> DrawClocks(const Options& options);
/// A line a camera.
std::string ClocksText(const Options& options, const std::vector<ClockOptions>& clocks);

}  // namespace rgbdt::simulate
