#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "services/messages/message.h"

namespace rgbdt {

/// One role of the system as a pure machine: messages and time in, messages out. No clock, no bus,
/// no threads, no files but where a role's header says so. What a node waits for, merges by time,
/// drops and guarantees stands in its header. `rgbdt replay` and the processes run the same nodes.
class Node {
 public:
  using WarningHandler = std::function<void(const std::string& warning)>;

  virtual ~Node() = default;

  /// Name of the process: "assembler".
  virtual std::string name() const = 0;

  /// Channels to subscribe to, as regular expressions: "CLOUD", ".*_IMAGE".
  virtual std::vector<std::string> Subscriptions() const = 0;

  /// Whether it would rather lose images and clouds than be late with the newest, where it gets
  /// less time than it needs (LcmBus::WantNewest).
  virtual bool WantsNewest() const { return false; }

  /// Takes one message. Throws InputError for one that cannot be used: the caller drops it, counts
  /// it and names it in the status. The node is then as if the message had never come. What follows
  /// from a message and is not its sender's fault is a warning. Messages that come back, here and
  /// below, are numbered by the caller; but one whose number is kSaidAgain keeps it.
  virtual Messages Handle(const Message& message) = 0;

  /// It is `now` [us]: does what is due, and repeats what processes that start late need. The clock
  /// is the caller's. It only grows; its zero is anywhere, and messages' times are of other clocks.
  /// A process hands in its machine's steady clock, after each batch of messages and every
  /// LongestWait() at least; `rgbdt replay` hands in the newest time in a message. What goes wrong
  /// is a warning.
  virtual Messages Advance(Utime /*now*/) { return {}; }

  /// What the node does beside its role, and can wait: called by a process where no message waits
  /// to be handled, and where that does not come, now and then all the same (NodeRunner); Advance
  /// follows. `now` is Advance's. What goes wrong is a warning.
  virtual Messages UseSpareTime(Utime /*now*/) { return {}; }

  /// The longest time between two calls of Advance [us] where no message comes.
  virtual Utime LongestWait() const { return 50'000; }

  /// Ready, and what it does or waits for. The caller adds name, times and its own counters.
  virtual Status GetStatus() const = 0;

  /// There is nothing left to do: the process ends.
  virtual bool finished() const { return false; }

  /// Called with each warning, e.g. "POSE of gps jumps ...", from within Handle and Advance.
  void SetWarningHandler(WarningHandler handler) { warning_handler_ = std::move(handler); }

 protected:
  void Warn(const std::string& warning) const {
    if (warning_handler_) warning_handler_(warning);
  }

 private:
  WarningHandler warning_handler_;
};

}  // namespace rgbdt
