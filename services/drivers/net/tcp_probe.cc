#include "services/drivers/net/tcp_probe.h"

#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <memory>

#include "calib/model/descriptor.h"

namespace rgbdt {
namespace {

using AddressList = std::unique_ptr<addrinfo, decltype(&freeaddrinfo)>;

AddressList LookUp(const std::string& address, int port) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* list = nullptr;
  if (getaddrinfo(address.c_str(), std::to_string(port).c_str(), &hints, &list) != 0) {
    list = nullptr;
  }
  return {list, freeaddrinfo};
}

TcpAnswer Judge(int error) {
  if (error == 0) return TcpAnswer::kConnected;
  if (error == ECONNREFUSED || error == ECONNRESET) return TcpAnswer::kRefused;
  if (error == ETIMEDOUT) return TcpAnswer::kTimedOut;
  return TcpAnswer::kUnreachable;
}

int ErrorOf(const Descriptor& tcp) {
  int error = 0;
  socklen_t size = sizeof error;
  return getsockopt(tcp.get(), SOL_SOCKET, SO_ERROR, &error, &size) == 0 ? error : errno;
}

}  // namespace

TcpAnswer ProbeTcp(const std::string& address, int port, int timeout_ms) {
  const AddressList list = LookUp(address, port);
  if (list == nullptr) return TcpAnswer::kBadAddress;
  const Descriptor tcp(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (connect(tcp.get(), list->ai_addr, list->ai_addrlen) == 0) return TcpAnswer::kConnected;
  if (errno != EINPROGRESS) return Judge(errno);
  pollfd descriptor{tcp.get(), POLLOUT, 0};
  if (poll(&descriptor, 1, timeout_ms) <= 0) return TcpAnswer::kTimedOut;
  return Judge(ErrorOf(tcp));
}

}  // namespace rgbdt
