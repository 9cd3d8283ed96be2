#pragma once

#include <lcm/lcm.h>

#include <functional>
#include <memory>
#include <string>

#include "services/bus/bus.h"
#include "services/bus/internal/udp_sender.h"

namespace rgbdt {

/// What LCM sends to itself to see whether a bus works.
inline constexpr char kSelfTestChannel[] = "LCM_SELF_TEST";

/// How much may wait for a subscriber.
struct Room {
  std::size_t messages = 0;
  /// Who wants the newest rather than all: beyond so many bytes the oldest go. 0: it wants all.
  std::size_t newest_bytes = 0;
};

/// Where an LcmBus hears from. Handlers throw nothing.
class Source {
 public:
  virtual ~Source() = default;
  /// Throws InputError where `channel_regex` is none.
  virtual void Subscribe(const std::string& channel_regex, const Room& room,
                         Bus::Handler handler) = 0;
  /// Readable while a message waits.
  virtual int descriptor() const = 0;
  /// Hands on the message that waits. False: nothing will come any more.
  virtual bool Deliver() = 0;
  virtual Malformed malformed() const { return {}; }
  virtual LinkReport links() const { return {}; }
  virtual Utime arrived() const { return 0; }  ///< of Bus
};

/// What `lcm` hears itself: a log file. Null where it hears nothing.
std::unique_ptr<Source> MakeLcmSource(lcm_t* lcm);

/// The bus of a udpm URL, received by a thread of its own. LCM's own receiver believes what a
/// datagram says of itself, and two of them end the process; this one holds each to its bytes. It
/// hears the group only, not what is sent to the machine; with ttl 0 nothing from other machines.
/// `send_test` sends a message on kSelfTestChannel; null where none comes back within 10 s. With a
/// sender, which outlives it, the two repair what networks lose: what is missing is asked for by
/// it, and it answers others. Throws InputError where the kernel refuses the socket.
std::unique_ptr<Source> MakeUdpSource(const BusUrl& url, const std::function<void()>& send_test,
                                      UdpSender* sender);

}  // namespace rgbdt
