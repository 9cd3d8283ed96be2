#pragma once

#include <functional>
#include <map>
#include <string>

#include "services/bus/bus.h"
#include "services/runtime/node.h"

namespace rgbdt {

/// Which bus, and with which key.
struct BusFlags {
  std::string url = {};  ///< empty: LCM_DEFAULT_URL, or LCM's default
  std::string key = {};  ///< file of the rig's key (bus_key.h); empty: RGBDT_KEY, or else none
};

/// The main loop of a process: the node on LCM until it is finished, SIGINT, SIGTERM or a log's
/// end. The node's time is the machine's steady clock; its status goes out at 1 Hz. Logs how large
/// the receive buffer ought to be, and each problem, the same one at most every five seconds.
/// Returns the exit code: 0, or 1 with one line on stderr where the bus cannot be opened.
/// With a key it signs what it sends and ignores what is not signed (signed_bus.h).
/// `overhear` gets every message that is on the bus, as bytes, signed or not.
int RunOnLcm(Node& node, const BusFlags& flags, const Bus::Handler& overhear = {});

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
