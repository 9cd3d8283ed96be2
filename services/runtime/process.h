#pragma once

#include <functional>
#include <string>

#include "services/runtime/device_thread.h"
#include "services/runtime/node_runner.h"

namespace rgbdt {

/// Called in each turn of the loop, so that a simulator or driver can publish; it should not
/// block. False ends the process.
using Idle = std::function<bool(NodeRunner& runner)>;

/// The main loop of a process: the node on LCM until SIGINT, SIGTERM or a log's end, its status at
/// 1 Hz of the machine's steady clock. Says on the log how large the receive buffer ought to be,
/// and each problem, the same one at most every five seconds. Returns the exit code: 0, or 1 with
/// one line on stderr where the bus cannot be opened or `idle` throws. `overhear` gets every
/// message that is on the bus, as bytes.
int RunOnLcm(Node& node, const std::string& url, const Idle& idle = {},
             const Bus::Handler& overhear = {});

/// The main loop of a device's process: what the device says is published, what it complains about
/// is named in the status and on the log. Ends with a device that has nothing more to say.
int RunDevice(DeviceNode& node, const std::string& url);

/// Says a problem, unless it said the same within five seconds; then it counts. Time [s] comes
/// from the caller.
class ProblemLog {
 public:
  using Say = std::function<void(const std::string& line)>;
  explicit ProblemLog(Say say) : say_(std::move(say)) {}
  void Add(const std::string& problem, double now_s);

 private:
  struct Entry {
    double said_s;
    std::int64_t unsaid;
  };
  Say say_;
  std::map<std::string, Entry> entries_;
};

}  // namespace rgbdt
