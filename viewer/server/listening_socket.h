#pragma once

#include <string>

#include "viewer/server/net.h"

namespace rgbdt::viewer {

/// Listens. Throws InputError: which address, why, and what to do.
tcp::acceptor ListenAt(net::io_context* io, const std::string& address, int port);

/// Takes over a socket that listens already. Throws InputError where it is none of TCP.
tcp::acceptor ListenOn(net::io_context* io, int socket);

/// The same as a descriptor, to be handed on.
int ListeningSocket(const std::string& address, int port);

/// Whether only this machine reaches an address, or a socket that is bound to one.
bool IsLoopback(const std::string& address);
bool IsLoopback(int socket);

/// "127.0.0.1:8080", "[::1]:8080"
std::string HostPortText(const std::string& address, int port);

/// As a person writes it: IPv4 also where it came mapped into IPv6.
std::string AddressText(const net::ip::address& address);

/// What environment variables and descriptor 3 say of sockets handed in; see HandedInSocket().
int HandedInSocket(const char* listen_pid, const char* listen_fds, int first_socket);

}  // namespace rgbdt::viewer
