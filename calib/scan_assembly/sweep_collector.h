#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "calib/model/cloud.h"

namespace rgbdt {

/// Sweeps by their name, as their chunks come in. Keeps the newest kMinSweeps, and of a LIDAR that
/// sweeps many times a second as many as have kKeptPoints, kMaxSweeps at most: a capture names a
/// sweep that ended a while ago.
class SweepCollector {
 public:
  static constexpr std::size_t kMinSweeps = 3, kMaxSweeps = 100;
  static constexpr std::size_t kKeptPoints = 6'000'000;
  static constexpr std::size_t kMaxChunks = 100'000;    ///< of one sweep
  static constexpr std::size_t kMaxPoints = 8'000'000;  ///< of one sweep, lost lines included
  static constexpr double kMaxMissing = 0.01;           ///< of its lines: gaps look like edges

  /// One that came before is not kept twice. Those that are said again (kSaidAgain) take the place
  /// of all that came of their sweep: it is as whoever says them has it. Throws InputError for a
  /// chunk that cannot be joined to those of its sweep.
  void Add(CloudChunk chunk);
  /// Those of a sweep so far, in the order in which they came; empty: none came, or they are no
  /// longer kept.
  std::vector<CloudChunk> ChunksOf(Utime sweep_utime) const;
  /// The sweep, or nothing while its end has not come. Lines that never came, at its head and tail,
  /// too, are there as lines of which nothing is known (JoinChunks).
  std::optional<Cloud> Complete(Utime sweep_utime) const;
  /// Why a sweep that has ended is not to be used: more than kMaxMissing of its lines never came.
  /// Empty: it is whole, or it has not ended.
  std::string WhyTorn(Utime sweep_utime) const;
  bool Ended(Utime sweep_utime) const;
  /// Name of the newest sweep that is complete; 0: none is.
  Utime NewestEnded() const;
  /// Names of the newest sweeps that have begun, at most so many, in order.
  std::vector<Utime> Newest(std::size_t most) const;
  void Clear() { sweeps_.clear(); }

 private:
  struct Sweep {
    std::vector<CloudChunk> chunks;
    std::optional<std::size_t> first;  // of them that has points
    bool said_again = false;
    std::set<std::tuple<int, int, int, bool>> came;  // first line, lines, beams, whether it ends
    std::size_t points = 0;
    int lines = 0;  // that it must have, as far as its chunks have told
    bool ended = false;
  };
  static void Check(const Sweep& sweep, const CloudChunk& chunk);
  void ForgetOldest();

  std::map<Utime, Sweep> sweeps_;
};

}  // namespace rgbdt
