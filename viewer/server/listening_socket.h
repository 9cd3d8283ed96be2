#pragma once

#include <string>

namespace rgbdt::viewer {

/// A descriptor that listens, to be handed on. Throws InputError: which address, why, and what to
/// do.
int ListeningSocket(const std::string& address, int port);

/// Whether only this machine reaches an address, or a socket that is bound to one.
bool IsLoopback(const std::string& address);
bool IsLoopback(int socket);

/// "127.0.0.1:8080", "[::1]:8080"
std::string HostPortText(const std::string& address, int port);

/// What environment variables and descriptor 3 say of sockets handed in; see HandedInSocket().
int HandedInSocket(const char* listen_pid, const char* listen_fds, int first_socket);

}  // namespace rgbdt::viewer
