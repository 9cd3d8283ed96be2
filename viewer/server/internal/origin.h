#pragma once

#include <string>
#include <vector>

namespace rgbdt::viewer {

/// Which names of this server a browser may use. A page of another site whose name was made to
/// resolve to this machine (DNS rebinding) comes with that site's name.
struct HostRule {
  int port = 80;
  bool tls = false;                  ///< https
  std::vector<std::string> names;    ///< lower case; IPv6 without brackets
  bool any_address_literal = false;  ///< what is no name cannot be rebound

  /// `host` as a request has it: "localhost:8080", "[::1]:8080"; no port is 80, or 443 by TLS.
  bool Allows(const std::string& host) const;
};

/// The rule for a socket bound so. Beyond loopback the machine's own name and all addresses count.
HostRule RuleFor(const std::string& bound_address, int port, bool tls = false);

/// The Origin is "http://", by TLS "https://", and that host.
bool OriginIsHost(const std::string& origin, const std::string& host, bool tls = false);

/// Takes the same time wherever they differ.
bool SameToken(const std::string& given, const std::string& token);

/// Names of this machine, lower case: "rig.lab", "rig", "rig.local".
std::vector<std::string> MachineNames();

}  // namespace rgbdt::viewer
