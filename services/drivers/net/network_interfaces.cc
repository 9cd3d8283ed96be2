#include "services/drivers/net/network_interfaces.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <bitset>
#include <cerrno>
#include <cstring>

#include "calib/model/descriptor.h"

namespace rgbdt {
namespace {

std::uint32_t Number(const sockaddr* address) {
  if (address == nullptr || address->sa_family != AF_INET) return 0;
  sockaddr_in in{};
  std::memcpy(&in, address, sizeof in);
  return ntohl(in.sin_addr.s_addr);
}

// Asked of the kernel and not of /sys: what is mounted there may be another namespace's.
int Mtu(const std::string& name) {
  const Descriptor udp(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  ifreq request{};
  std::strncpy(request.ifr_name, name.c_str(), IFNAMSIZ - 1);
  return ioctl(udp.get(), SIOCGIFMTU, &request) == 0 ? request.ifr_mtu : 0;
}

NetworkInterface MakeInterface(const ifaddrs& entry) {
  NetworkInterface made;
  made.name = entry.ifa_name;
  made.index = static_cast<int>(if_nametoindex(entry.ifa_name));
  made.up = (entry.ifa_flags & IFF_UP) != 0;
  made.loopback = (entry.ifa_flags & IFF_LOOPBACK) != 0;
  made.multicast = (entry.ifa_flags & IFF_MULTICAST) != 0;
  made.mtu = Mtu(made.name);
  return made;
}

void AddEntry(const ifaddrs& entry, std::vector<NetworkInterface>* interfaces) {
  auto found =
      std::find_if(interfaces->begin(), interfaces->end(),
                   [&](const NetworkInterface& known) { return known.name == entry.ifa_name; });
  if (found == interfaces->end()) {
    found = interfaces->insert(interfaces->end(), MakeInterface(entry));
  }
  if (entry.ifa_addr == nullptr || entry.ifa_addr->sa_family != AF_INET) return;
  const bool has_broadcast = (entry.ifa_flags & IFF_BROADCAST) != 0;
  found->addresses.push_back({Number(entry.ifa_addr), Number(entry.ifa_netmask),
                              has_broadcast ? Number(entry.ifa_broadaddr) : 0});
}

}  // namespace

std::string AddressText(std::uint32_t address) {
  const in_addr in{htonl(address)};
  char text[INET_ADDRSTRLEN] = "";
  inet_ntop(AF_INET, &in, text, sizeof text);
  return text;
}

bool ParseAddress(const std::string& text, std::uint32_t* address) {
  in_addr in{};
  if (inet_pton(AF_INET, text.c_str(), &in) != 1) return false;
  *address = ntohl(in.s_addr);
  return true;
}

int PrefixLength(std::uint32_t mask) { return static_cast<int>(std::bitset<32>(mask).count()); }

std::vector<NetworkInterface> ListInterfaces() {
  std::vector<NetworkInterface> interfaces;
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) return interfaces;
  for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
    AddEntry(*entry, &interfaces);
  }
  freeifaddrs(list);
  return interfaces;
}

std::string InterfaceInSubnet(std::uint32_t address,
                              const std::vector<NetworkInterface>& interfaces) {
  for (const NetworkInterface& interface : interfaces) {
    for (const InterfaceAddress& own : interface.addresses) {
      if (interface.up && SameSubnet(own.address, address, own.mask)) return interface.name;
    }
  }
  return "";
}

}  // namespace rgbdt
