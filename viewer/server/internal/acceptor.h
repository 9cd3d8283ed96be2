#pragma once

#include <string>

#include "viewer/server/internal/net.h"

namespace rgbdt::viewer {

/// Listens. Throws InputError: which address, why, and what to do.
tcp::acceptor ListenAt(net::io_context* io, const std::string& address, int port);

/// Takes over a socket that listens already. Throws InputError where it is none of TCP.
tcp::acceptor ListenOn(net::io_context* io, int socket);

/// As a person writes it: IPv4 also where it came mapped into IPv6.
std::string AddressText(const net::ip::address& address);

}  // namespace rgbdt::viewer
