#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "calib/model/time.h"
#include "services/bus/sequence.h"

namespace rgbdt::viewer {

/// Rate, size, latency and losses of every channel, from the messages' bytes alone: what lcm-spy
/// shows. Nothing is decoded but the two fields that every type begins with, utime and seq.
class BusMonitor {
 public:
  /// A message that came at `now_s` of a steady clock, `now_utime` of the wall clock.
  void Add(const std::string& channel, const std::uint8_t* data, std::size_t size, double now_s,
           Utime now_utime);

  /// The channels of a BusFrame: rates over the last kWindow seconds; latency_ms null where a
  /// channel's times are not of this machine's clock (a simulation's, a log's).
  nlohmann::json Channels(double now_s) const;

  static constexpr double kWindow = 3;              ///< [s]
  static constexpr std::size_t kMaxChannels = 200;  ///< strangers' names do not fill the memory
  static constexpr double kSameClock = 60;          ///< [s] farther off is another clock

 private:
  struct Arrival {
    double at_s;
    std::size_t bytes;
  };
  struct Channel {
    std::deque<Arrival> newest;  // within the window
    std::int64_t count = 0;
    std::size_t size = 0;
    double latency_s = 0;
    bool has_latency = false;
    std::int64_t lost = 0;
    std::map<std::string, SequenceCounter> senders;
  };

  std::map<std::string, Channel> channels_;
};

}  // namespace rgbdt::viewer
