#pragma once

#include <functional>
#include <map>
#include <string>

#include "services/bus/bus.h"
#include "services/bus/sequence.h"
#include "services/runtime/node.h"

namespace rgbdt {

/// Puts a node on a bus: decodes what the node subscribes to, hands it over, numbers and publishes
/// what comes back. A message that cannot be decoded or used is dropped, counted and named in the
/// status; gaps in the senders' numbers are counted by channel. No exception leaves a handler, and
/// none leaves Publish and Tick: what cannot be sent is dropped, counted and named likewise.
///
/// Numbers (sequence.h) are kept by channel, on STATUS, SESSION_EVENT and POSE by channel and
/// sender, since several processes speak there. Late and repeated messages are handed over as they
/// come: what their order means only the node knows. A message that cannot be decoded is dropped
/// and also leaves a gap, as its number is unknown.
class NodeRunner {
 public:
  using ProblemHandler = std::function<void(const std::string& problem)>;

  /// Subscribes at once. Both outlive the runner, and the runner the bus' deliveries.
  NodeRunner(Node* node, Bus* bus);
  NodeRunner(const NodeRunner&) = delete;
  NodeRunner& operator=(const NodeRunner&) = delete;

  /// Numbers and publishes, as if the node had said it.
  void Publish(Messages messages);

  /// Names a problem of the node's own: in the status and to the problem handler.
  void NameProblem(const std::string& problem);

  /// At 1 Hz: what the node repeats, and its status.
  void Tick();

  /// The node's own, with the runner's name, time, newest problem and counters: "received",
  /// "dropped", "gaps", then, where not zero, "late", "duplicates", "restarts", "dropped CLOUD",
  /// "gaps CLOUD".
  Status GetStatus() const;

  /// Called with each problem, e.g. "CLOUD: num_points is -1".
  void SetProblemHandler(ProblemHandler handler) { problem_handler_ = std::move(handler); }

  std::int64_t received() const { return received_; }
  std::int64_t dropped() const { return dropped_; }
  std::int64_t gaps() const { return gaps_; }

 private:
  void OnBytes(const std::string& channel, const std::uint8_t* data, std::size_t size);
  void CountGap(const std::string& channel, const Message& message);
  void PublishOne(Message message);
  /// Runs `action`; what it throws is counted and named.
  void Guard(const std::string& channel, const std::function<void()>& action);
  void Drop(const std::string& channel, const std::string& what);

  Node* node_;
  Bus* bus_;
  ProblemHandler problem_handler_;
  std::map<std::string, std::int64_t> next_seq_;      // of what is published, by sequence
  std::map<std::string, SequenceCounter> sequences_;  // of what is received
  std::map<std::string, std::int64_t> dropped_by_channel_, gaps_by_channel_;
  std::string last_problem_;
  Utime newest_utime_ = 0;
  std::int64_t received_ = 0, dropped_ = 0, gaps_ = 0;
  std::int64_t late_ = 0, duplicates_ = 0, restarts_ = 0;
};

}  // namespace rgbdt
