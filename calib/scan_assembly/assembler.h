#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "calib/model/cloud.h"
#include "calib/model/rig.h"
#include "calib/scan_assembly/encoder_track.h"

namespace rgbdt {

/// Lines and encoder readings, as they come -> chunks of sweeps. A chunk (one line) leaves as soon
/// as the encoder has been read at or after the line's last beam; a sweep's first line waits kGrace
/// longer. A line's place in the sweep is its number minus that of the sweep's first line, so lines
/// may arrive kGrace out of order, among themselves or against the readings, and the cloud is the
/// same, bit for bit. The sweep ends with the first reading kGrace after the encoder stopped naming
/// it, or with a line of another sweep: then an empty chunk with `sweep_end`. Lines up to
/// a sweep's last that never came, or whose angles are not known (readings missing for more than
/// kMaxGap), are counted in `lines_lost`: those before its first, too, as where this was started in
/// the midst of the sweep, by the time since the sweep's start and the numbers that are missing.
/// Refused with an InputError, which changes nothing: a reading that is not after the one before
/// it, a line seen before, one that by its number is after a line of a later time, one whose sweep
/// has ended, one more than kKept older than the newest reading. Between sweeps (sweep_utime 0)
/// lines make no cloud.
///
/// A clock set back by more than kClockReset, or a log longer than that which is looped, begins
/// anew. One set back by less is refused until it is again where it was, one set forward leaves a
/// gap: the sweep at hand lacks lines, which are counted; later ones are as if nothing had been.
class Assembler {
 public:
  static constexpr std::size_t kMaxWaiting = 1000;               ///< lines
  static constexpr std::int64_t kMaxLines = 100000;              ///< of a sweep
  static constexpr Utime kMaxGap = kMicrosecondsPerSecond / 10;  ///< between encoder readings
  static constexpr Utime kGrace = kMicrosecondsPerSecond / 10;   ///< for late lines
  static constexpr Utime kKept = kMicrosecondsPerSecond;         ///< of readings
  static constexpr Utime kClockReset = 10 * kMicrosecondsPerSecond;

  /// Since the start, whatever scanners there were.
  struct Counts {
    std::int64_t lines_used = 0;
    std::int64_t lines_lost = 0;
    std::int64_t sweeps = 0;
  };

  explicit Assembler(const TurnedScanner& scanner) : scanner_(scanner) {}

  /// Another geometry, which forgets the sweep at hand.
  void SetScanner(const TurnedScanner& scanner);

  std::vector<CloudChunk> Add(const EncoderReading& as_stamped);
  std::vector<CloudChunk> Add(const LineScan& line);

  const Counts& counts() const { return counts_; }
  /// Lines of the sweep at hand that have left; nothing between sweeps.
  std::optional<std::size_t> LinesOfSweep() const;

 private:
  using Chunks = std::vector<CloudChunk>;

  struct Sweep {
    Utime utime = 0;
    std::int64_t first_seq = 0;
    std::set<int> sent;  // lines, by their place in the sweep
    int lines = 0;       // up to the last that came, sent or not
  };

  struct Place {
    Utime utime = 0;
    std::int64_t seq = 0;
  };

  void CheckLine(const LineScan& line) const;
  bool FitsSweep(const LineScan& line) const;
  Utime SweepOf(const LineScan& line) const;
  /// When the sweep of this name began: names are as stamped.
  Utime StartOf(Utime sweep) const { return sweep - FromSeconds(scanner_.encoder_delay_s); }
  bool IsReady(const LineScan& line) const;
  bool FollowsAllBefore(const LineScan& line) const;
  std::int64_t LinesLostBefore(const LineScan& first, Utime sweep_utime,
                               const std::optional<Place>& before) const;
  double LinePeriodAt(const LineScan& line, const std::optional<Place>& before) const;
  Chunks Drain();
  void AddToSweep(const LineScan& line, Chunks* out);
  void EndSweep(Chunks* out);
  void Forget();

  TurnedScanner scanner_;
  EncoderTrack track_;
  std::map<Utime, LineScan> waiting_;
  std::optional<Sweep> sweep_;
  Utime ended_ = 0;              // the newest sweep that has ended
  std::optional<Place> newest_;  // of the lines that are done with
  Counts counts_;
};

}  // namespace rgbdt
