#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "calib/model/time.h"

namespace rgbdt {

/// Sweep commands that are not answered yet: each is done with the first whole sweep that began
/// after it came. A live sensor's sweeps may lie in the kernel's buffer for a while, so there the
/// time decides, and that by the steady clock: the one that sweeps are called by may be set while a
/// command waits.
class PendingSweeps {
 public:
  struct Clocks {
    Utime host, steady;  ///< at the same moment
  };

  /// `begun`: the name of the newest sweep that has begun; `now`: of a live sensor only.
  void Add(std::int64_t command, Utime begun, const std::optional<Clocks>& now) {
    pending_.push_back({command, begun, now});
  }
  /// The commands that a sweep, which is whole now, answers.
  std::vector<std::int64_t> TakeAnswered(Utime sweep, const std::optional<Clocks>& now) {
    std::vector<Pending> still;
    std::vector<std::int64_t> answered;
    for (const Pending& pending : pending_) {
      if (BeganAfter(pending, sweep, now)) {
        answered.push_back(pending.command);
      } else {
        still.push_back(pending);
      }
    }
    pending_ = std::move(still);
    return answered;
  }
  std::vector<std::int64_t> TakeAll() {
    std::vector<std::int64_t> all;
    for (const Pending& pending : std::exchange(pending_, {})) all.push_back(pending.command);
    return all;
  }
  void Clear() { pending_.clear(); }

 private:
  struct Pending {
    std::int64_t command;
    Utime begun;
    std::optional<Clocks> came;
  };
  static bool BeganAfter(const Pending& pending, Utime sweep, const std::optional<Clocks>& now) {
    if (!pending.came || !now) return sweep > pending.begun;
    if (sweep == pending.begun) return false;
    const Utime age = now->host - sweep;
    return now->steady - age > pending.came->steady;
  }

  std::vector<Pending> pending_;
};

}  // namespace rgbdt
