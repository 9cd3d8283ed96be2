#pragma once

#include <cstdint>
#include <string_view>

#include "calib/model/session.h"

namespace rgbdt {

// Counters of a STATUS that others read.

/// Then a machine's name: by how much its clock is ahead of the sender's, where that is too much.
inline constexpr char kClockCounter[] = "clock ahead [ms] ";

/// The counter of that name; `otherwise` where the status has none.
inline std::int64_t CounterOf(const Status& status, std::string_view name,
                              std::int64_t otherwise = 0) {
  for (const auto& [counter, value] : status.counters) {
    if (counter == name) return value;
  }
  return otherwise;
}

}  // namespace rgbdt
