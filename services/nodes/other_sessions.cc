#include "services/nodes/other_sessions.h"

#include "services/messages/check.h"
#include "services/messages/status_counters.h"

namespace rgbdt {
namespace {

constexpr const char* kId = "session";
constexpr const char* kListens = "listens";
constexpr const char* kEnded = "ended";

// Of one that does not tell its id, as of an older version: -1.
std::int64_t IdOf(const Status& status) { return CounterOf(status, kId, -1); }

std::string Named(const Status& other) {
  constexpr std::size_t kMaxBytes = 400;
  return "another rgbdt-session is on this bus (it says: " + Printable(other.text, kMaxBytes) +
         "), and two erase each other's views";
}

}  // namespace

void OtherSessions::Tell(std::int64_t id, bool listens, bool ended, Status* status) {
  status->counters.insert(status->counters.end(),
                          {{kId, id}, {kListens, listens ? 1 : 0}, {kEnded, ended ? 1 : 0}});
}

bool OtherSessions::IsAnother(const Status& status) const {
  return status.process == "session" && IdOf(status) != own_id_ && CounterOf(status, kEnded) == 0;
}

std::optional<std::string> OtherSessions::WhyGiveWay(const Status& status) const {
  if (!IsAnother(status)) return std::nullopt;
  if (CounterOf(status, kListens) != 0 && IdOf(status) > own_id_) return std::nullopt;
  return Named(status) +
         "; wait for its end or stop it, or give this one a bus of its own "
         "(--lcm-url)";
}

std::optional<std::string> OtherSessions::Warning(const Status& status) {
  if (!IsAnother(status) || named_.size() >= kMaxNamed) return std::nullopt;
  if (!named_.insert(IdOf(status)).second) return std::nullopt;
  return Named(status) + "; stop one of them, or give it a bus of its own (--lcm-url)";
}

}  // namespace rgbdt
