#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>

#include "calib/model/session.h"

namespace rgbdt {

/// Which session it is, of those that a bus may carry.
struct SessionIdentity {
  static constexpr std::int64_t kIds = std::int64_t{1} << 20;

  std::int64_t id = 0;  ///< below kIds, drawn by lot
  std::string place;    ///< where it writes, for a person: HOST:FOLDER; empty: not told
  Utime listen = 0;     ///< how long it listens for others before it sends anything [us]

  /// Commands' numbers are above this one: the id stands in their high bits, so that answers to
  /// another session's commands are none.
  std::int64_t FirstCommand() const { return id << 32; }
};

/// Who else leads a session on the bus, by STATUS. Each session tells its id there, whether it
/// listens still, and whether it has ended. Of two that both listen the one with the larger id
/// gives way, otherwise the one that listens: so one stays, whichever hears the other first.
class OtherSessions {
 public:
  static constexpr std::size_t kMaxNamed = 100;

  explicit OtherSessions(std::int64_t own_id) : own_id_(own_id) {}

  /// What the session's own STATUS has of it.
  static void Tell(std::int64_t id, bool listens, bool ended, Status* status);

  /// Why this session, which listens, must give way to the one that the STATUS is of.
  std::optional<std::string> WhyGiveWay(const Status& status) const;
  /// Once for each other session that a session which does not listen any more hears of.
  std::optional<std::string> Warning(const Status& status);

 private:
  bool IsAnother(const Status& status) const;

  std::int64_t own_id_;
  std::set<std::int64_t> named_;
};

}  // namespace rgbdt
