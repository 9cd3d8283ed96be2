#include "services/bus/multicast.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>

#include "calib/model/descriptor.h"
#include "services/bus/bus.h"
#include "services/bus/bus_url.h"

namespace rgbdt {
namespace {

Descriptor UdpSocket() { return Descriptor(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)); }

// The address of udpm://239.255.76.67:7667?ttl=0; LCM's default where the URL gives none.
std::string AddressOf(const std::string& url) {
  const std::size_t begin = std::strlen("udpm://");
  const std::string address = url.substr(begin, url.find_first_of(":?", begin) - begin);
  return address.empty() ? "239.255.76.67" : address;
}

// Why no datagram can go to the address; 0: one can.
int RouteError(const in_addr& address) {
  const Descriptor udp = UdpSocket();
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(7667);
  to.sin_addr = address;
  return connect(udp.get(), reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0 ? 0 : errno;
}

}  // namespace

std::string WhyNoBus(const std::string& url) {
  const std::string expected = "expected a URL like udpm://239.255.76.67:7667?ttl=0";
  if (url.compare(0, 7, "udpm://") != 0) return "LCM refuses it (see above); " + expected;
  const std::string text = AddressOf(url);
  in_addr address{};
  if (inet_pton(AF_INET, text.c_str(), &address) != 1 || !IN_MULTICAST(ntohl(address.s_addr))) {
    return "\"" + text + "\" is no multicast address; " + expected;
  }
  const int error = RouteError(address);
  const std::string commands = "ip link set lo up multicast on && ip route add 239.0.0.0/8 dev lo";
  if (error != 0) {
    return "no multicast route (" + std::string(std::strerror(error)) +
           "); to stay within this machine: " + commands;
  }
  return "LCM refuses it (see above), or its test message did not come back: a wrong port, a "
         "firewall, or an interface without multicast; to stay within this machine: " +
         commands;
}

// What the kernel grants is asked of a socket: in a network namespace there is no
// /proc/sys/net/core/rmem_max to read, and its limit holds all the same.
std::string ReceiveBufferAdvice() {
  const Descriptor udp = UdpSocket();
  const int wanted = kReceiveBufferBytes;
  int granted = 0;
  socklen_t size = sizeof granted;
  setsockopt(udp.get(), SOL_SOCKET, SO_RCVBUF, &wanted, sizeof wanted);
  if (getsockopt(udp.get(), SOL_SOCKET, SO_RCVBUF, &granted, &size) != 0) return "";
  granted /= 2;  // Linux doubles what it grants, for its own bookkeeping
  if (granted >= wanted) return "";
  return "the kernel's receive buffer is limited to " + std::to_string(granted) +
         " bytes, so large messages (images, clouds) may be lost under load: sudo sysctl -w "
         "net.core.rmem_max=" +
         std::to_string(wanted);
}

std::string WhyNotHeard(const std::string& url) {
  const BusUrl bus = ParseBusUrl(url);
  if (bus.ttl == 0) {
    return "the bus stays on this machine (" + url +
           "): processes on other machines are heard with ttl=1 in LCM_DEFAULT_URL, on each of "
           "them";
  }
  return "with ttl=" + std::to_string(bus.ttl) +
         " here, processes on other machines are heard where they have it, too, and the same group "
         "and port; rgbdt doctor on each says by which interface they speak";
}

}  // namespace rgbdt
