#pragma once

#include <cstdint>
#include <vector>

#include "services/drivers/clock_fit.h"

namespace rgbdt {

/// The clock of a SCIP scanner [ms, 24 bit] on the host's.
///
/// How late the times asked for (TM1) arrive is known: half the way there and back. How late scans
/// arrive is not: the scan must be over, then comes what the scanner takes to send it. So the scans
/// of the first seconds are timed by the times asked for, and what they were late at least is taken
/// off from then on. Seconds are the scanner's own, and end where the host's clock is set back
/// (a scan that arrived before it was made). Asking for times needs the laser off, so it is done
/// once. Where the scanner gives no times, a scan's own duration is what is taken off.
class ScipClock {
 public:
  /// `scan_us`: from step 0 to the last one measured.
  explicit ScipClock(Utime scan_us);

  /// A time asked for: when it arrived [us, UTC], and how long after it was asked for [us].
  void AddTime(std::uint32_t time_ms, Utime arrival, Utime round_trip);

  struct ScanTime {
    Utime utime = 0;       ///< of step 0, on the host's clock
    std::int64_t ms = 0;   ///< the scanner's clock, not wrapped
    bool was_set = false;  ///< somebody set a clock: the times begin anew
  };
  /// A scan's time and when its last byte arrived.
  ScanTime AddScan(std::uint32_t time_ms, Utime arrival);

  /// The least delay of scans that is taken off [us].
  Utime scan_delay_us() const { return scan_delay_us_; }

 private:
  static constexpr std::int64_t kLearnMs = 2000;
  bool StillLearns(std::int64_t ms, Utime arrival);
  bool EndLearning();
  Utime DelayOf(std::int64_t ms, Utime arrival) const;

  CounterUnwrapper counter_;
  ClockFit fit_;
  bool learning_ = false;
  std::int64_t learn_until_ms_ = 0;  // scanner's clock
  Utime scan_delay_us_;
  std::vector<std::pair<std::int64_t, Utime>> learnt_from_;
};

}  // namespace rgbdt
