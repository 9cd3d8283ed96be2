#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/scan_assembly/sweep_collector.h"
#include "calib/sync/sync.h"
#include "services/messages/message.h"

namespace rgbdt {

struct WavedLogOptions {
  double most_range_m = 8;  ///< what returned from farther away is not the board
  /// Of a longer log what comes later is not read.
  std::size_t most_sweeps = 600, most_images = 2400, most_points = 20'000'000;
  bool find_poses = false;  ///< of all cameras, though a calibration tells them
};

/// What a log holds of a waved board.
struct WavedLog {
  Rig rig;
  std::optional<Calibration> calibration;   ///< what the search began from
  std::optional<RangeErrors> range_errors;  ///< of that, by which the sweeps were corrected
  WavedBoard board;
  std::vector<std::string> problems;  ///< of what could not be used, a line each
};

/// Why a waved board tells nothing to a rig: a turned scanner, a plain board; empty: it does.
std::string WhyNotWaved(const Rig& rig);

/// Message by message: the board in each image, and what lies about it in each sweep. Sweeps are
/// corrected by the calibration's range errors, unless `find_poses`. Poses are the calibration's;
/// where a camera has none, boards are looked for in the sweeps, too.
class WaveReader {
 public:
  /// Throws InputError where WhyNotWaved says why, or the calibration is another rig's.
  WaveReader(const Rig& rig, const std::optional<Calibration>& calibration,
             const WavedLogOptions& options);

  /// Takes a CloudChunk or an Image; throws InputError for one that cannot be used.
  void Take(const Message& message);
  /// That is as much as the options allow.
  bool Full() const;

  const WavedBoard& board() const { return read_.board; }
  /// All of it, at the end.
  WavedLog Finish() { return std::move(read_); }

 private:
  void TakeChunk(const CloudChunk& chunk);
  void FindIn(const Cloud& sweep, WavedSweep* waved) const;
  void TakeImage(const Image& image);

  WavedLog read_;
  WavedLogOptions options_;
  SweepCollector sweeps_;
  bool look_for_boards_ = false;
  Utime last_sweep_ = 0;
  std::size_t images_ = 0, points_ = 0;
};

}  // namespace rgbdt
