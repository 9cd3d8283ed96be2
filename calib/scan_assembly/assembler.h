#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "calib/model/cloud.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// One line in 3D: point_in_lidar = Rz(angle) * motor_from_scanner * (r cos a, 0, r sin a), with
/// the motor's angle of each beam (the motor turns while a line is fired). `angles` [rad] is as
/// long as the line. Misses keep their direction.
Cloud LineToCloud(const TurnedScanner& scanner, const LineScan& line,
                  const std::vector<double>& angles);

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

/// Throws InputError where two chunks of a sweep differ in beams per line or in which of a cloud's
/// vectors they fill.
void RequireJoinable(const Cloud& a, const Cloud& b);

/// Puts chunks back together, in the order of their lines; a chunk that came twice counts once.
/// Lines that never came become lines of NaN without known directions, so neighbours in the cloud
/// are neighbours in the sweep. Throws InputError where they are not joinable.
Cloud JoinChunks(const std::vector<CloudChunk>& chunks);

}  // namespace rgbdt
