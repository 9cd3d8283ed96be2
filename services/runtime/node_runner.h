#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "services/bus/bus.h"
#include "services/bus/sequence.h"
#include "services/runtime/answered_commands.h"
#include "services/runtime/node.h"
#include "services/runtime/periodic.h"

namespace rgbdt {

/// Puts a node on a bus: decodes what the node subscribes to, hands it over, numbers and publishes
/// what comes back. A message that cannot be decoded or used is dropped, counted and named in the
/// status; gaps in the senders' numbers are counted by channel. No exception leaves a handler, and
/// none leaves Advance: what cannot be sent is dropped, counted and named likewise.
///
/// Numbers (sequence.h) are kept by channel, on STATUS, SESSION_EVENT and POSE by channel and
/// sender, since several processes speak there. What is said again (kSaidAgain) has none. Late and
/// repeated messages are handed over as they come: what their order means only the node knows; but
/// a session's command that came before is not handed over, the node's last word on it is said
/// again (AnsweredCommands). A channel of one sender whose numbers keep falling back is named: two
/// programs send on it. A message that cannot be decoded is dropped and also leaves a gap, as its
/// number is unknown.
class NodeRunner {
 public:
  using ProblemHandler = std::function<void(const std::string& problem)>;

  /// Subscribes at once. Both outlive the runner, and the runner the bus' deliveries.
  NodeRunner(Node* node, Bus* bus);
  ~NodeRunner() { node_->SetWarningHandler({}); }
  NodeRunner(const NodeRunner&) = delete;
  NodeRunner& operator=(const NodeRunner&) = delete;

  /// It is `now` [us] of the caller's clock (Node::Advance): publishes what the node then has, and
  /// once a second its status.
  void Advance(Utime now);

  /// Node::UseSpareTime: at once where no message waits, else once kLongestBusy after the last
  /// time, so that it has a turn under any load. `now` is Advance's.
  void UseSpareTime(Utime now, bool messages_wait);
  static constexpr Utime kLongestBusy = 5 * kMicrosecondsPerSecond;

  /// The node's own, with the runner's name, time, newest problem and counters: "received",
  /// "dropped", "gaps", then, where not zero, "late", "duplicates", "restarts", "malformed" (what
  /// reached the bus and was no message), "unsigned" (what a process with a key did not take),
  /// "dropped CLOUD", "gaps CLOUD", and what the links between
  /// machines lost (LinkReport): "datagrams lost", "datagrams repaired", "messages given up",
  /// "ip fragments given up", and kClockCounter for each machine whose clock is off.
  Status GetStatus() const;

  /// Called with each problem, the node's warnings among them, e.g. "CLOUD: num_points is -1".
  void SetProblemHandler(ProblemHandler handler) { problem_handler_ = std::move(handler); }

  std::int64_t received() const { return received_; }
  std::int64_t dropped() const { return dropped_; }
  std::int64_t gaps() const { return gaps_; }
  /// The newest time in a message that was taken; 0 before the first.
  Utime newest_utime() const { return newest_utime_; }

 private:
  void OnBytes(const std::string& channel, const std::uint8_t* data, std::size_t size);
  void CountGap(const std::string& channel, const Message& message);
  void Publish(Messages messages);
  void PublishOne(Message message);
  /// Runs `action`; what it throws is counted and named.
  void Guard(const std::string& channel, const std::function<void()>& action);
  void Drop(const std::string& channel, const std::string& what);
  void NameProblem(const std::string& problem);
  void NameMalformed();
  void NameLinks();
  void NameSharedChannels();
  void NameUnsigned();

  Node* node_;
  Bus* bus_;
  ProblemHandler problem_handler_;
  Periodic status_{kMicrosecondsPerSecond};
  std::optional<Utime> spared_;  // when it had spare time last
  Periodic links_{10 * kMicrosecondsPerSecond};
  AnsweredCommands commands_;
  std::map<std::string, std::int64_t> next_seq_;      // of what is published, by sequence
  std::map<std::string, SequenceCounter> sequences_;  // of what is received
  std::map<std::string, std::int64_t> dropped_by_channel_, gaps_by_channel_;
  std::string last_problem_;
  Utime newest_utime_ = 0;
  std::int64_t received_ = 0, dropped_ = 0, gaps_ = 0;
  std::int64_t late_ = 0, duplicates_ = 0, restarts_ = 0;
  std::int64_t malformed_named_ = 0, lost_named_ = 0, ip_lost_named_ = 0;
  std::map<std::string, int> fallen_back_;  // numbers, by channel, since links_ was due
  std::int64_t unsigned_named_ = 0;
};

}  // namespace rgbdt
