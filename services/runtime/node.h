#pragma once

#include <string>
#include <vector>

#include "services/messages/message.h"

namespace rgbdt {

/// One role of the system as a pure machine: messages in, messages out. No clock, no bus, no
/// threads, no files but where a role's header says so. What a node waits for, merges by time,
/// drops and guarantees stands in its header. `rgbdt replay` and the processes run the same nodes.
class Node {
 public:
  virtual ~Node() = default;

  /// Name of the process: "assembler".
  virtual std::string name() const = 0;

  /// Channels to hear, as regular expressions: "CLOUD", ".*_IMAGE".
  virtual std::vector<std::string> Subscriptions() const = 0;

  /// Takes one message. Throws InputError for one that cannot be used: the caller drops it, counts
  /// it and names it in the status. The node's state is then as before.
  virtual Messages Handle(const Message& message) = 0;

  /// What is to be heard again by who came late; called at 1 Hz by a process, never in a replay.
  virtual Messages Republish() { return {}; }

  /// Ready, and what it does or waits for. The caller adds name, times and its own counters.
  virtual Status GetStatus() const = 0;
};

}  // namespace rgbdt
