#pragma once

#include <cstddef>
#include <deque>
#include <optional>

#include "calib/model/cloud.h"
#include "calib/model/session.h"
#include "calib/model/time.h"

namespace rgbdt {

/// Chunks of clouds in the order in which they came, each held until poses that come after it tell
/// where it was seen: rgbdt-odometry knows the way of a turned scanner's sweep at the sweep's end,
/// and the last second of it with the next one. Where poses are another source's, or none come,
/// each chunk is due at once. None waits for longer than two sweeps and kSlack, nor do more than
/// kMostPoints points.
class ChunkQueue {
 public:
  static constexpr Utime kSlack = 2 * kMicrosecondsPerSecond;
  static constexpr Utime kLongestSweep = 30 * kMicrosecondsPerSecond;
  static constexpr std::size_t kMostPoints = 4'000'000;

  void OnPose(const StampedPose& pose);
  /// False: it is due at once, and is not kept.
  bool Keep(const CloudChunk& chunk);
  /// The first chunk, if it is due.
  std::optional<CloudChunk> Next();
  /// See Node::Advance: where neither chunks nor poses come any more, all are due.
  void Advance(Utime now);
  void Clear();

  bool empty() const { return chunks_.empty(); }
  std::size_t size() const { return chunks_.size(); }

 private:
  struct Waiting {
    CloudChunk chunk;
    Utime last = 0;  ///< of its points' times
  };

  Utime MostWait() const { return 2 * longest_sweep_ + kSlack; }
  // A chunk whose last point has this time; of the newest chunk it is `newest`.
  bool IsDue(Utime last, Utime newest) const;

  std::deque<Waiting> chunks_;
  std::size_t points_ = 0;
  std::optional<Utime> newest_pose_;  // odometry's
  Utime longest_sweep_ = 0;
  bool heard_ = false, given_up_ = false;
  Utime heard_at_ = 0;  // by the clock of Advance
};

}  // namespace rgbdt
