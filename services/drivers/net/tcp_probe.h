#pragma once

#include <string>

namespace rgbdt {

/// How a device on the network answers to being called.
enum class TcpAnswer {
  kConnected,
  kRefused,      ///< somebody is there, and nobody listens on the port
  kTimedOut,     ///< nobody answered
  kUnreachable,  ///< no way there, or the next router says so
  kBadAddress,   ///< neither an address nor a name that anybody knows
};

/// Connects and hangs up again.
TcpAnswer ProbeTcp(const std::string& address, int port, int timeout_ms = 1000);

}  // namespace rgbdt
