#pragma once

#include <cstdint>

namespace rgbdt {

/// Number (`seq`) of a message that is said again for who lacks it, perhaps by another process than
/// the first time: nobody counts it.
inline constexpr std::int64_t kSaidAgain = -1;

}  // namespace rgbdt
