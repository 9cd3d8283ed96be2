#pragma once

#include <string>

namespace rgbdt {

/// As this machine calls itself; "?" if it has no name.
std::string HostName();

}  // namespace rgbdt
