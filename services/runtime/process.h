#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

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
/// the receive buffer ought to be, and problems (ProblemLog).
/// Returns the exit code: 0, or 1 with one line on stderr where the bus cannot be opened.
/// With a key it signs what it sends and ignores what is not signed (signed_bus.h).
/// `overhear` gets every message that is on the bus, as bytes, signed or not.
int RunOnLcm(Node& node, const BusFlags& flags, const Bus::Handler& overhear = {});

/// Logs problems in few lines, whatever flood they come in: one a second of each source, and the
/// same one every five seconds, but at once what is of another kind, up to eight kinds of a source;
/// what is left out is counted, and told with the next line or five seconds later. A source is what
/// stands before a problem's first colon (a channel), but for digits; of very many sources those
/// that come last count as one. Time [us] comes from the caller.
class ProblemLog {
 public:
  using Write = std::function<void(const std::string& line)>;
  explicit ProblemLog(Write write) : write_(std::move(write)) {}
  void Add(const std::string& problem, Utime now);
  /// Tells what was left out a while ago.
  void Advance(Utime now);

 private:
  struct Source {
    std::string written;  // empty: nothing yet
    Utime written_at = 0;
    std::string left_out;  // the newest
    std::int64_t count = 0;
    std::vector<std::string> kinds;  // of texts written so far: without their numbers
  };
  void WriteOf(Source* source, const std::string& problem, std::int64_t more, Utime now);

  Write write_;
  std::map<std::string, Source> sources_;
};

}  // namespace rgbdt
