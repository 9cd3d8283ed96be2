#pragma once

#include <string>

namespace rgbdt {

/// What LCM needs of a socket so that large messages arrive whole.
inline constexpr int kReceiveBufferBytes = 33554432;

/// After LCM could not open `url`: the likely reason, and what to do.
std::string WhyNoBus(const std::string& url);

/// Why a process on another machine may not be heard on the bus `url`, and what to do.
std::string WhyNotHeard(const std::string& url);

}  // namespace rgbdt
