#include "services/drivers/camera/gvcp_discovery.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <set>
#include <tuple>

#include "calib/model/descriptor.h"

namespace rgbdt {
namespace {

using Clock = std::chrono::steady_clock;
using Bytes = std::vector<std::uint8_t>;

constexpr auto kPatience = std::chrono::milliseconds(500);
constexpr std::uint32_t kEverybody = 0xffffffff;
constexpr std::uint16_t kId = 0x5244;

sockaddr_in SocketAddress(std::uint32_t address, int port) {
  sockaddr_in in{};
  in.sin_family = AF_INET;
  in.sin_port = htons(static_cast<std::uint16_t>(port));
  in.sin_addr.s_addr = htonl(address);
  return in;
}

void Send(const Descriptor& udp, std::uint32_t address, const Bytes& bytes) {
  const sockaddr_in to = SocketAddress(address, kGvcpPort);
  // An interface that refuses is one where no camera answers.
  sendto(udp.get(), bytes.data(), bytes.size(), MSG_DONTWAIT,
         reinterpret_cast<const sockaddr*>(&to), sizeof to);
}

std::optional<Bytes> Receive(const Descriptor& udp) {
  Bytes bytes(2048);
  const ssize_t size = recv(udp.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
  if (size < 0) return {};
  bytes.resize(static_cast<std::size_t>(size));
  return bytes;
}

// A socket that hears and says on one interface only. It is bound to no address: an answer that a
// camera broadcasts would not reach it otherwise.
Descriptor OpenOn(const NetworkInterface& interface) {
  Descriptor udp(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  const int on = 1;
  setsockopt(udp.get(), SOL_SOCKET, SO_BROADCAST, &on, sizeof on);
  if (setsockopt(udp.get(), SOL_SOCKET, SO_BINDTODEVICE, interface.name.c_str(),
                 static_cast<socklen_t>(interface.name.size())) != 0) {
    return Descriptor();
  }
  return udp;
}

struct Listener {
  std::string interface;
  Descriptor udp;
};

// Set: an interface's broadcast address may be 255.255.255.255 itself.
std::set<std::uint32_t> Targets(const NetworkInterface& interface,
                                const std::vector<std::uint32_t>& also) {
  std::set<std::uint32_t> targets(also.begin(), also.end());
  targets.insert(kEverybody);
  for (const InterfaceAddress& own : interface.addresses) {
    if (own.broadcast != 0) targets.insert(own.broadcast);
    if (interface.loopback) targets.insert(own.address);  // a simulated camera
  }
  return targets;
}

std::vector<Listener> Ask(const std::vector<NetworkInterface>& interfaces,
                          const std::vector<std::uint32_t>& also) {
  const Bytes question = MakeGvcpDiscovery(kId);
  std::vector<Listener> listeners;
  for (const NetworkInterface& interface : interfaces) {
    if (!interface.up) continue;
    Listener listener{interface.name, OpenOn(interface)};
    if (!listener.udp) continue;
    for (const std::uint32_t target : Targets(interface, also)) {
      Send(listener.udp, target, question);
    }
    listeners.push_back(std::move(listener));
  }
  return listeners;
}

// False: nothing more came before `end`.
bool WaitUntil(Clock::time_point end, std::vector<pollfd>* descriptors) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now());
  if (left.count() <= 0) return false;
  return poll(descriptors->data(), descriptors->size(), static_cast<int>(left.count())) > 0;
}

std::vector<FoundGvcpDevice> Listen(const std::vector<Listener>& listeners) {
  std::vector<pollfd> descriptors;
  descriptors.reserve(listeners.size());
  for (const Listener& listener : listeners) descriptors.push_back({listener.udp.get(), POLLIN, 0});
  std::vector<FoundGvcpDevice> found;
  const Clock::time_point end = Clock::now() + kPatience;
  while (WaitUntil(end, &descriptors)) {
    for (const Listener& listener : listeners) {
      const std::optional<Bytes> bytes = Receive(listener.udp);
      if (!bytes) continue;
      if (const auto device = ParseGvcpDiscovery(*bytes, kId)) {
        found.push_back({*device, listener.interface});
      }
    }
  }
  return found;
}

}  // namespace

std::vector<FoundGvcpDevice> DiscoverGvcp(const std::vector<NetworkInterface>& interfaces,
                                          const std::vector<std::uint32_t>& also) {
  std::vector<FoundGvcpDevice> found = Listen(Ask(interfaces, also));
  const auto key = [](const FoundGvcpDevice& f) {
    return std::tie(f.interface, f.device.serial, f.device.mac);
  };
  // It was asked at more than one address, and answers each time.
  std::sort(found.begin(), found.end(),
            [&](const auto& a, const auto& b) { return key(a) < key(b); });
  found.erase(std::unique(found.begin(), found.end(),
                          [&](const auto& a, const auto& b) { return key(a) == key(b); }),
              found.end());
  return found;
}

GvcpControl AskGvcpControl(std::uint32_t address) {
  const Descriptor udp(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  const sockaddr_in to = SocketAddress(address, kGvcpPort);
  // Connected: nobody else's datagrams come in, and "port unreachable" ends the wait.
  if (connect(udp.get(), reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0) {
    return GvcpControl::kNoAnswer;
  }
  Send(udp, address, MakeGvcpReadRegister(kId, kGvcpControlPrivilege));
  std::vector<pollfd> descriptors{{udp.get(), POLLIN, 0}};
  const Clock::time_point end = Clock::now() + kPatience;
  while (WaitUntil(end, &descriptors)) {
    const std::optional<Bytes> bytes = Receive(udp);
    if (!bytes) return GvcpControl::kNoAnswer;
    const auto read = ParseGvcpRegister(*bytes, kId);
    if (!read) continue;
    // A camera whose control is exclusive refuses others even this.
    return read->status == 0 && read->value == 0 ? GvcpControl::kFree : GvcpControl::kHeld;
  }
  return GvcpControl::kNoAnswer;
}

}  // namespace rgbdt
