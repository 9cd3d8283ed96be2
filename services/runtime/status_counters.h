#pragma once

namespace rgbdt {

// Counters of a STATUS that others read.

/// Then a machine's name: by how much its clock is ahead of the sender's, where that is too much.
inline constexpr char kClockCounter[] = "clock ahead [ms] ";

}  // namespace rgbdt
