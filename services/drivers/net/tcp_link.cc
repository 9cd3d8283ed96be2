#include "services/drivers/net/tcp_link.h"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>

#include "services/posix/clock.h"
#include "services/runtime/device_thread.h"

namespace rgbdt {
namespace {

struct FreeAddress {
  void operator()(addrinfo* info) const { freeaddrinfo(info); }
};
using Address = std::unique_ptr<addrinfo, FreeAddress>;

bool WaitFor(int socket, short events, int timeout_ms) {
  pollfd waiting{socket, events, 0};
  return poll(&waiting, 1, timeout_ms) > 0;
}

// 0, or the errno why not.
int Connect(int socket, const addrinfo& to, int timeout_ms) {
  if (connect(socket, to.ai_addr, to.ai_addrlen) == 0) return 0;
  if (errno != EINPROGRESS) return errno;
  if (!WaitFor(socket, POLLOUT, timeout_ms)) return ETIMEDOUT;
  int error = 0;
  socklen_t size = sizeof(error);
  if (getsockopt(socket, SOL_SOCKET, SO_ERROR, &error, &size) != 0) return errno;
  return error;
}

}  // namespace

TcpLink::TcpLink(const std::string& address, int port, int timeout_ms)
    : name_(address + ":" + std::to_string(port)) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int why = getaddrinfo(address.c_str(), std::to_string(port).c_str(), &hints, &found);
  if (why != 0) {
    Fail(std::string("is no address: ") + gai_strerror(why) + "; correct it in the rig file");
  }
  const Address to(found);
  socket_ = socket(to->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (socket_ < 0) Fail(std::string("no socket to be had: ") + std::strerror(errno));
  const int error = Connect(socket_, *to, timeout_ms);
  if (error != 0) {
    close(socket_);
    Fail(std::string("cannot be reached (") + std::strerror(error) +
         "); is it switched on and on this network, and is its address in the rig file right?");
  }
  const int yes = 1;
  setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof(yes));
}

TcpLink::~TcpLink() { close(socket_); }

void TcpLink::Fail(const std::string& what) const { throw DeviceError(name_ + ": " + what); }

void TcpLink::Send(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent > 0) {
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      constexpr int kTimeoutMs = 1000;
      if (!WaitFor(socket_, POLLOUT, kTimeoutMs)) Fail("takes no command for a second");
    } else if (errno != EINTR) {
      Fail(std::string("the connection broke (") + std::strerror(errno) + ")");
    }
  }
}

std::string TcpLink::Receive(int timeout_ms) {
  if (!WaitFor(socket_, POLLIN, timeout_ms)) return {};
  char bytes[16 * 1024];
  const ssize_t got = recv(socket_, bytes, sizeof(bytes), 0);
  arrival_ = HostUtime();
  steady_arrival_ = SteadyUtime();
  if (got > 0) return std::string(bytes, static_cast<std::size_t>(got));
  if (got == 0) Fail("closed the connection; is another program connected to it?");
  if (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR) return {};
  Fail(std::string("the connection broke (") + std::strerror(errno) + ")");
}

}  // namespace rgbdt
