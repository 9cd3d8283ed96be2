#pragma once

#include <functional>
#include <map>
#include <string>

#include "services/bus/bus.h"
#include "services/runtime/node.h"

namespace rgbdt {

/// The main loop of a process: the node on LCM until it is finished, SIGINT, SIGTERM or a log's
/// end. The node's time is the machine's steady clock; its status goes out at 1 Hz. Logs how large
/// the receive buffer ought to be, and each problem, the same one at most every five seconds.
/// Returns the exit code: 0, or 1 with one line on stderr where the bus cannot be opened.
/// `overhear` gets every message that is on the bus, as bytes.
int RunOnLcm(Node& node, const std::string& url, const Bus::Handler& overhear = {});

/// Logs a problem, unless it logged the same within five seconds; then it counts. Time [us] comes
/// from the caller.
class ProblemLog {
 public:
  using Write = std::function<void(const std::string& line)>;
  explicit ProblemLog(Write write) : write_(std::move(write)) {}
  void Add(const std::string& problem, Utime now);

 private:
  struct Entry {
    Utime written;
    std::int64_t since;  // not written
  };
  Write write_;
  std::map<std::string, Entry> entries_;
};

}  // namespace rgbdt
