#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "services/messages/message.h"

namespace rgbdt {

/// What the session asked of a process, and how that ended. The session repeats a command until it
/// is answered, since command or answer may be lost: a node gets it once, and its last word is said
/// again. Of the newest kKept commands; a command without a number (0) is always new.
class AnsweredCommands {
 public:
  static constexpr std::size_t kKept = 64;

  /// False: it came before, and is not for the node. A RESET begins a new session.
  bool IsNew(const SessionCommand& command);
  /// The node could not use it yet: sent again it is new.
  void Forget(const SessionCommand& command);
  /// What the node says of a command: done or failed is its last word.
  void Remember(const SessionEvent& event);
  /// The last word on a command; nothing: the node is still at it, or has no part in it.
  std::optional<SessionEvent> LastWord(std::int64_t command) const;

 private:
  struct Asked {
    std::int64_t command;
    SessionVerb verb;
    Utime utime;
    std::optional<SessionEvent> last_word;
  };
  std::deque<Asked> asked_;
};

}  // namespace rgbdt
