#include "services/drivers/packets/udp_port.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "services/posix/clock.h"
#include "services/runtime/device_thread.h"

namespace rgbdt {
namespace {

// A fifth of a second of the fastest, where the kernel allows it (net.core.rmem_max, which `rgbdt
// doctor` looks at).
constexpr int kBufferBytes = 8 * 1024 * 1024;
constexpr std::size_t kMaxDatagram = 65'536;  // an Ouster's have up to 25 kB

// When the kernel had it: a busy process does not make it later.
Utime ArrivalOf(msghdr* message) {
  for (cmsghdr* c = CMSG_FIRSTHDR(message); c != nullptr; c = CMSG_NXTHDR(message, c)) {
    if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SCM_TIMESTAMP) continue;
    timeval time{};
    std::memcpy(&time, CMSG_DATA(c), sizeof(time));
    return Utime{time.tv_sec} * kMicrosecondsPerSecond + time.tv_usec;
  }
  return HostUtime();
}

}  // namespace

UdpPort::UdpPort(int port) : bytes_(kMaxDatagram) {
  const std::string name = "UDP port " + std::to_string(port);
  socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (socket_ < 0) throw DeviceError(name + ": no socket to be had: " + std::strerror(errno));
  const int yes = 1;
  setsockopt(socket_, SOL_SOCKET, SO_TIMESTAMP, &yes, sizeof(yes));
  setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &kBufferBytes, sizeof(kBufferBytes));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_ANY);
  auto* raw = reinterpret_cast<sockaddr*>(&address);
  socklen_t size = sizeof(address);
  if (bind(socket_, raw, size) != 0 || getsockname(socket_, raw, &size) != 0) {
    const int error = errno;
    close(socket_);
    throw DeviceError(error == EADDRINUSE
                          ? name +
                                " is in use: another program listens to the LIDAR; end it (ss "
                                "-ulnp names it), or give the LIDAR another port"
                          : name + " cannot be listened at: " + std::strerror(error));
  }
  port_ = ntohs(address.sin_port);
}

UdpPort::~UdpPort() { close(socket_); }

std::optional<UdpPort::Datagram> UdpPort::Receive(int timeout_ms) {
  pollfd waiting{socket_, POLLIN, 0};
  if (poll(&waiting, 1, timeout_ms) <= 0) return std::nullopt;
  alignas(cmsghdr) char control[256];
  iovec part{bytes_.data(), bytes_.size()};
  sockaddr_in sender{};
  msghdr message{};
  message.msg_name = &sender;
  message.msg_namelen = sizeof(sender);
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control;
  message.msg_controllen = sizeof(control);
  const ssize_t size = recvmsg(socket_, &message, 0);
  if (size < 0) return std::nullopt;
  return Datagram{
      ArrivalOf(&message), {bytes_.begin(), bytes_.begin() + size}, sender.sin_addr.s_addr};
}

}  // namespace rgbdt
