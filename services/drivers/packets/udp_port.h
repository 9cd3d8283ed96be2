#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "calib/model/time.h"

namespace rgbdt {

/// A UDP port of this machine.
class UdpPort {
 public:
  /// 0: any free one. Throws DeviceError, for example where another program has it.
  explicit UdpPort(int port);
  ~UdpPort();
  UdpPort(const UdpPort&) = delete;
  UdpPort& operator=(const UdpPort&) = delete;

  int port() const { return port_; }
  struct Datagram {
    Utime utime = 0;  ///< when the kernel had it
    std::vector<std::uint8_t> payload;
    std::uint32_t sender = 0;  ///< its IPv4 address, as on the wire
  };
  /// The next datagram, at most after `timeout_ms`; nothing: none came.
  std::optional<Datagram> Receive(int timeout_ms);

 private:
  int socket_ = -1;
  int port_ = 0;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace rgbdt
