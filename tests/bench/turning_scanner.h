#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "calib/model/cloud.h"
#include "calib/model/rig.h"
#include "calib/model/rigid3.h"
#include "services/messages/message.h"

namespace rgbdt::bench {

/// The simulator's default rig, nothing rendered: its rig file's text, its cameras' true places.
struct BenchRig {
  Rig rig;
  RigText text;
  std::vector<Rigid3> camera_from_lidar;

  /// As the solver publishes it, one a camera.
  Messages Calibrations(Utime utime) const;
};
BenchRig MakeBenchRig();

/// The default scanner, turning to and fro without a pause in a round room: 25 lines of 400 beams
/// a second, an encoder reading each 10 ms, every 50th beam a miss. Any line can be had at once.
class TurningScanner {
 public:
  static constexpr int kBeams = 400;
  static constexpr int kSweepLines = 300;
  static constexpr Utime kLinePeriod = 40'000;
  static constexpr Utime kReadingPeriod = 10'000;

  explicit TurningScanner(Utime start) : start_(start) {}

  LineScan Line(std::int64_t number) const;
  EncoderReading Reading(std::int64_t number) const;
  Utime start() const { return start_; }

 private:
  Utime start_;
};

}  // namespace rgbdt::bench
