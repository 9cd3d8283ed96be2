#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace rgbdt {

/// IPv4 addresses are numbers here, 192.168.0.1 = 0xc0a80001; 0: none.
std::string AddressText(std::uint32_t address);
/// False where the text is no dotted address.
bool ParseAddress(const std::string& text, std::uint32_t* address);
/// 24 of 0xffffff00.
int PrefixLength(std::uint32_t mask);
inline bool SameSubnet(std::uint32_t a, std::uint32_t b, std::uint32_t mask) {
  return (a & mask) == (b & mask);
}

struct InterfaceAddress {
  std::uint32_t address = 0, mask = 0, broadcast = 0;
};

/// An interface of this network namespace.
struct NetworkInterface {
  std::string name;
  int index = 0;
  bool up = false, loopback = false, multicast = false;
  int mtu = 0;                              ///< [byte]; 0: unknown
  std::vector<InterfaceAddress> addresses;  ///< IPv4; may be none
};

/// Empty where the kernel does not tell.
std::vector<NetworkInterface> ListInterfaces();

/// The interface that has an address in the same subnet; empty: none.
std::string InterfaceInSubnet(std::uint32_t address,
                              const std::vector<NetworkInterface>& interfaces);

/// Where the kernel would send a datagram.
struct Route {
  int error = 0;             ///< errno: why it could not
  std::uint32_t source = 0;  ///< this machine's address that it would carry
  std::string interface;     ///< empty: unknown
};
Route RouteTo(std::uint32_t address);

}  // namespace rgbdt
