#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "calib/model/cloud.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// A reading at the time when the motor was there (TurnedScanner::encoder_delay_s). The sweep keeps
/// its name.
EncoderReading OnTime(const TurnedScanner& scanner, EncoderReading reading);

/// Motor angle over time from encoder readings, interpolated linearly.
class EncoderTrack {
 public:
  /// Readings must come in the order of their times; one that does not is refused (false).
  bool Add(const EncoderReading& reading);

  /// Between two readings the motor turns evenly.
  struct Stretch {
    Utime from = 0, until = 0;  ///< `until` is the next one's
    double angle = 0;           ///< [rad] at `from`
    double turn = 0;            ///< [rad] up to `until`

    bool Contains(Utime utime) const { return from <= utime && utime < until; }
    double AngleAt(Utime utime) const {
      return angle + static_cast<double>(utime - from) / static_cast<double>(until - from) * turn;
    }
  };

  /// The stretch that holds a time, of two readings at most `max_gap` apart; nothing otherwise.
  std::optional<Stretch> StretchAt(const TurnedScanner& scanner, Utime utime, Utime max_gap) const;

  /// Angle [rad] at a time between two readings at most `max_gap` apart; nothing otherwise.
  std::optional<double> AngleAt(const TurnedScanner& scanner, Utime utime, Utime max_gap) const;

  /// The sweep that a time belongs to: that of the newest reading at or before it; 0: none.
  Utime SweepAt(Utime utime) const;

  /// Newest reading's time; 0 before the first.
  Utime newest() const { return readings_.empty() ? 0 : readings_.back().utime; }

  /// Forgets what lies before `utime`, but for the last reading before it.
  void ForgetBefore(Utime utime);

 private:
  std::deque<EncoderReading> readings_;
};

/// The motor's angle [rad] when each beam of a line was fired; nothing where one is not known.
std::optional<std::vector<double>> BeamAngles(const TurnedScanner& scanner,
                                              const EncoderTrack& track, const LineScan& line,
                                              Utime max_gap);

}  // namespace rgbdt
