#pragma once

#include <cstdint>
#include <vector>

namespace rgbdt {

/// Bytes of one message, as encoded by its LCM type.
using Bytes = std::vector<std::uint8_t>;

}  // namespace rgbdt
