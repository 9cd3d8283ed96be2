#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/statvfs.h>
#include <sys/timex.h>

#include <algorithm>
#include <cerrno>

#include "calib/model/descriptor.h"
#include "services/bus/multicast.h"
#include "services/doctor/facts.h"

namespace rgbdt {
namespace {

constexpr int kEchoMs = 300;

Descriptor UdpSocket() { return Descriptor(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)); }

sockaddr_in Anybody(int port) {
  sockaddr_in in{};
  in.sin_family = AF_INET;
  in.sin_port = htons(static_cast<std::uint16_t>(port));
  return in;
}

int Bind(const Descriptor& udp, sockaddr_in* address) {
  const int result = bind(udp.get(), reinterpret_cast<sockaddr*>(address), sizeof *address);
  return result == 0 ? 0 : errno;
}

// Linux doubles what it grants, for its own bookkeeping.
std::int64_t GrantedBuffer() {
  const Descriptor udp = UdpSocket();
  const int wanted = kReceiveBufferBytes;
  int granted = 0;
  socklen_t size = sizeof granted;
  setsockopt(udp.get(), SOL_SOCKET, SO_RCVBUF, &wanted, sizeof wanted);
  getsockopt(udp.get(), SOL_SOCKET, SO_RCVBUF, &granted, &size);
  return granted / 2;
}

// A datagram to the group on a port that nobody else has; ttl 0 keeps it on this machine.
bool ComesBack(std::uint32_t group) {
  const Descriptor udp = UdpSocket();
  sockaddr_in own = Anybody(0);
  socklen_t size = sizeof own;
  if (Bind(udp, &own) != 0) return false;
  getsockname(udp.get(), reinterpret_cast<sockaddr*>(&own), &size);
  ip_mreq membership{};
  membership.imr_multiaddr.s_addr = htonl(group);
  const int ttl = 0;
  setsockopt(udp.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership);
  setsockopt(udp.get(), IPPROTO_IP, IP_MULTICAST_TTL, &ttl, sizeof ttl);
  own.sin_addr.s_addr = htonl(group);
  const char nothing = 0;
  sendto(udp.get(), &nothing, 1, 0, reinterpret_cast<sockaddr*>(&own), sizeof own);
  pollfd descriptor{udp.get(), POLLIN, 0};
  return poll(&descriptor, 1, kEchoMs) > 0 && (descriptor.revents & POLLIN) != 0;
}

}  // namespace

BufferFacts GatherBuffer(const SystemRoots& roots) {
  BufferFacts facts;
  // In a network namespace there may be no such file, and the limit holds all the same.
  const auto limit = ReadNumber(roots.proc / "sys/net/core/rmem_max");
  const std::int64_t granted = GrantedBuffer();
  facts.largest = limit ? std::min(*limit, granted) : granted;
  facts.in_container = InContainer(roots);
  return facts;
}

MulticastFacts GatherMulticast(std::uint32_t group,
                               const std::vector<NetworkInterface>& interfaces) {
  MulticastFacts facts;
  facts.group = group;
  facts.route = RouteTo(group);
  for (const NetworkInterface& interface : interfaces) {
    if (interface.loopback) facts.loopback_up = interface.up;
    if (interface.name == facts.route.interface) facts.interface = interface;
  }
  facts.came_back = facts.route.error == 0 && ComesBack(group);
  return facts;
}

ClockFacts GatherClock(const SystemRoots& roots) {
  timex clock{};  // modes 0: it is only read
  ClockFacts facts;
  facts.synchronised = adjtimex(&clock) >= 0 && (clock.status & STA_UNSYNC) == 0;
  facts.in_container = InContainer(roots);
  return facts;
}

DiskFacts GatherDisk(const std::string& folder) {
  DiskFacts facts;
  facts.folder = folder;
  struct statvfs disk {};
  if (statvfs(folder.c_str(), &disk) == 0) {
    facts.free_bytes = static_cast<std::int64_t>(disk.f_bavail * disk.f_frsize);
  }
  return facts;
}

PortFacts GatherPort(const SystemRoots& roots, int port, const std::string& what, bool shared) {
  PortFacts facts;
  facts.port = port;
  facts.what = what;
  const Descriptor udp = UdpSocket();
  const int on = 1;
  if (shared) setsockopt(udp.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  sockaddr_in address = Anybody(port);
  facts.error = Bind(udp, &address);
  if (facts.error != 0) facts.holders = HoldersOfUdpPort(roots, port);
  return facts;
}

}  // namespace rgbdt
