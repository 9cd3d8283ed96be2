#pragma once

#include <cstdint>

namespace rgbdt {

/// Follows the numbers of one sender on one channel (0, 1, 2, ...; from 0 again after a restart)
/// and says what each means. A receiver may begin anywhere.
class SequenceCounter {
 public:
  enum class Kind {
    kFirst,      ///< nothing to compare with
    kNext,       ///< the one expected
    kGap,        ///< those between it and the newest are missing
    kLate,       ///< one of the 63 before the newest that were missing: no longer a gap
    kDuplicate,  ///< one of the 63 before the newest, or the newest, once more
    kSaidAgain,  ///< it has no number
    kRestart,    ///< the sender counts anew: 0 after anything; a fall back by more than 63; a leap
                 ///< ahead of more than a million (nobody loses so many)
  };
  struct Step {
    Kind kind;
    std::int64_t gaps;  ///< by how much the number of missing messages changes; negative when late
  };

  /// Takes the number of the message that came. After a restart that begins below 64 those before
  /// it count as missing; one that begins higher is a stranger, joined midway.
  Step Add(std::int64_t seq);

 private:
  Step Restart(std::int64_t seq);

  std::int64_t newest_ = -1;
  std::uint64_t missing_ = 0;  // bit k: newest_ - k has not come
};

}  // namespace rgbdt
