#pragma once

#include <cstdint>
#include <string>

namespace rgbdt::viewer {

// The part of a frame's layout (protocol.ts) that its way to a browser needs.

inline constexpr std::size_t kIdBytes = 4;  ///< each connection writes its own id in their place

/// Long enough for the header that it announces.
bool IsFrame(const std::string& frame);

/// Bytes before the payload. `frame` must be one.
std::size_t HeaderBytes(const std::string& frame);

}  // namespace rgbdt::viewer
