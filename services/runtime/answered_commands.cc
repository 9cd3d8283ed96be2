#include "services/runtime/answered_commands.h"

#include <algorithm>

namespace rgbdt {

bool AnsweredCommands::IsNew(const SessionCommand& command) {
  if (command.command == 0) return true;
  const bool came = std::any_of(asked_.begin(), asked_.end(), [&](const Asked& asked) {
    return asked.command == command.command && asked.verb == command.verb &&
           asked.utime == command.utime;
  });
  if (came) return false;
  if (command.verb == SessionVerb::kReset) asked_.clear();
  if (asked_.size() == kKept) asked_.pop_front();
  asked_.push_back({command.command, command.verb, command.utime, std::nullopt});
  return true;
}

void AnsweredCommands::Forget(const SessionCommand& command) {
  asked_.erase(std::remove_if(asked_.begin(), asked_.end(),
                              [&](const Asked& a) { return a.command == command.command; }),
               asked_.end());
}

void AnsweredCommands::Remember(const SessionEvent& event) {
  if (event.kind == EventKind::kProgress) return;
  for (Asked& asked : asked_) {
    if (asked.command == event.command) asked.last_word = event;
  }
}

std::optional<SessionEvent> AnsweredCommands::LastWord(std::int64_t command) const {
  for (const Asked& asked : asked_) {
    if (asked.command == command) return asked.last_word;
  }
  return std::nullopt;
}

}  // namespace rgbdt
