#include "viewer/server/listening_socket.h"

#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>

#include "calib/model/errors.h"
#include "viewer/server/internal/acceptor.h"
#include "viewer/server/server.h"

namespace rgbdt::viewer {
namespace {

namespace errc = boost::system::errc;
using boost::system::error_code;

int IntegerOption(int socket, int level, int name) {
  int value = -1;
  socklen_t size = sizeof(value);
  return getsockopt(socket, level, name, &value, &size) == 0 ? value : -1;
}

bool IsListeningTcp(int socket) {
  const int family = IntegerOption(socket, SOL_SOCKET, SO_DOMAIN);
  return (family == AF_INET || family == AF_INET6) &&
         IntegerOption(socket, SOL_SOCKET, SO_TYPE) == SOCK_STREAM &&
         IntegerOption(socket, SOL_SOCKET, SO_ACCEPTCONN) == 1;
}

void CheckListeningTcp(int socket) {
  if (IsListeningTcp(socket)) return;
  throw InputError("socket " + std::to_string(socket) +
                   ", handed in by LISTEN_FDS, is no listening TCP socket; in systemd's .socket "
                   "unit set ListenStream= to an address and a port");
}

constexpr int kDefaultPort = 8080;
constexpr int kLastPort = 65535;

// Another port of the same address, to be tried.
std::string Use(const std::string& address, int port) {
  return "use --listen " + HostPortText(address, port < kLastPort ? port + 1 : kDefaultPort);
}

[[noreturn]] void FailToListen(const std::string& address, int port, const error_code& error) {
  const std::string where = HostPortText(address, port);
  if (error == errc::address_in_use) {
    throw InputError(where + " is in use; another rgbdt-viewer? " + Use(address, port));
  }
  if (error == errc::address_not_available) {
    throw InputError(address + " is no address of this machine; " +
                     Use("127.0.0.1", kDefaultPort - 1));
  }
  if (error == errc::permission_denied) {
    throw InputError(where + " is not permitted (ports below 1024 are root's); " +
                     Use(address, kDefaultPort - 1));
  }
  throw InputError(where + ": " + error.message() + "; " + Use(address, port));
}

}  // namespace

std::string HostPortText(const std::string& address, int port) {
  const bool v6 = address.find(':') != std::string::npos;
  return (v6 ? "[" + address + "]" : address) + ":" + std::to_string(port);
}

std::string AddressText(const net::ip::address& address) {
  if (!address.is_v6() || !address.to_v6().is_v4_mapped()) return address.to_string();
  return net::ip::make_address_v4(net::ip::v4_mapped, address.to_v6()).to_string();
}

tcp::acceptor ListenAt(net::io_context* io, const std::string& address, int port) {
  error_code error;
  const net::ip::address ip = net::ip::make_address(address, error);
  if (error) throw InputError("listen address is \"" + address + "\"; expected IPv4 or IPv6");
  const tcp::endpoint endpoint(ip, static_cast<std::uint16_t>(port));
  tcp::acceptor acceptor(*io);
  acceptor.open(endpoint.protocol(), error);
  if (!error) acceptor.set_option(tcp::acceptor::reuse_address(true), error);
  if (!error) acceptor.bind(endpoint, error);
  if (!error) acceptor.listen(tcp::acceptor::max_listen_connections, error);
  if (error) FailToListen(address, port, error);
  fcntl(acceptor.native_handle(), F_SETFD, FD_CLOEXEC);
  return acceptor;
}

tcp::acceptor ListenOn(net::io_context* io, int socket) {
  CheckListeningTcp(socket);
  const bool v6 = IntegerOption(socket, SOL_SOCKET, SO_DOMAIN) == AF_INET6;
  tcp::acceptor acceptor(*io);
  error_code error;
  acceptor.assign(v6 ? tcp::v6() : tcp::v4(), socket, error);
  if (error) throw InputError("socket " + std::to_string(socket) + ": " + error.message());
  return acceptor;
}

int ListeningSocket(const std::string& address, int port) {
  net::io_context io;
  return ListenAt(&io, address, port).release();
}

bool IsLoopback(const std::string& address) {
  error_code error;
  const net::ip::address ip = net::ip::make_address(address, error);
  return !error && ip.is_loopback();
}

bool IsLoopback(int socket) {
  net::io_context io;
  tcp::acceptor acceptor = ListenOn(&io, socket);
  const std::string bound = AddressText(acceptor.local_endpoint().address());
  acceptor.release();  // it is not ours to close
  return IsLoopback(bound);
}

int HandedInSocket(const char* listen_pid, const char* listen_fds, int first_socket) {
  if (listen_pid == nullptr || listen_fds == nullptr) return -1;
  if (listen_pid != std::to_string(getpid())) return -1;
  const std::string count = listen_fds;
  if (count == "0") return -1;
  if (count != "1") {
    throw InputError("LISTEN_FDS is " + count.substr(0, 20) +
                     "; expected 1: rgbdt-viewer listens at one address");
  }
  CheckListeningTcp(first_socket);
  fcntl(first_socket, F_SETFD, FD_CLOEXEC);
  return first_socket;
}

int HandedInSocket() {
  constexpr int kFirst = 3;
  return HandedInSocket(std::getenv("LISTEN_PID"), std::getenv("LISTEN_FDS"), kFirst);
}

}  // namespace rgbdt::viewer
