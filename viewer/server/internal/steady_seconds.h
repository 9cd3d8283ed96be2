#pragma once

#include <chrono>

namespace rgbdt::viewer {

/// The machine's steady clock [s].
inline double SteadySeconds() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration<double>(now).count();
}

}  // namespace rgbdt::viewer
