#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "calib/model/time.h"

namespace rgbdt {

/// Another machine's clock, as far as it can be told from here: to some milliseconds.
struct ClockOffset {
  std::string host;  ///< "sensor (10.0.0.2)"
  Utime ahead = 0;   ///< of this machine's clock [us]
};

/// What happened to messages on their way between machines, since the bus was opened. All 0 on a
/// bus that stays on its machine (ttl=0).
struct LinkReport {
  std::int64_t datagrams_lost = 0;      ///< they were sent and did not come
  std::int64_t datagrams_repaired = 0;  ///< came later, as they were asked for
  std::int64_t messages_given_up = 0;   ///< not whole; on channels that nobody here wants, too
  /// Pieces of datagrams larger than the network carries that this machine's kernel gave up as
  /// others of them did not come (ReasmFails): of LCM programs that are not ours.
  std::int64_t ip_fragments_given_up = 0;
  std::string worst;  ///< whose datagrams are lost most: "sensor (10.0.0.2): 17 of 2000"; or empty
  std::vector<ClockOffset> clocks;  ///< one a machine, this one among them
};

/// Which machines' clocks are off by more than kClockTolerance, each in words. With three machines
/// or more the most agree on what is right; of two it is not known which one is off.
inline constexpr Utime kClockTolerance = 20'000;
std::vector<std::string> ClockProblems(const std::vector<ClockOffset>& clocks);

/// A kernel's counter of datagrams that it could not put together from their IP fragments; 0 where
/// it does not tell.
std::int64_t ReassemblyFailures();

}  // namespace rgbdt
