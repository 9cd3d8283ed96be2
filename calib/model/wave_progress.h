#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/statistics.h"
#include "calib/model/time.h"

namespace rgbdt {

/// What a waved board tells of a camera's clock so far.
struct WavedClock {
  std::string camera;
  /// The LIDAR's time of an image's middle row is its utime + this; absent: not told.
  std::optional<Estimate> time_offset_s;
  std::string text;  ///< why nothing is told, or what is to be known beside it
};

/// What `rgbdt sync live` is at. The numbers are those of the `wave_progress_t` message.
enum class WavePhase {
  kWaiting = 1,    ///< for sweeps
  kRecording = 2,  ///< the board is to be waved
  kSolving = 3,
  kDone = 4,  ///< a result was written
  kFailed = 5,
};

/// How far `rgbdt sync live` has come.
struct WaveProgress {
  std::int64_t seq = 0;
  Utime utime = 0;  ///< newest sensor time that it heard; 0: none yet
  WavePhase phase = WavePhase::kWaiting;
  double left_s = 0;  ///< of the recording
  std::string text;   ///< for a person: what to do now, what was written, or why it failed
  std::vector<WavedClock> clocks;
};

}  // namespace rgbdt
