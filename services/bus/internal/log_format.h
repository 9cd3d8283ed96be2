#pragma once

#include <cstdint>

namespace rgbdt {

// An event of an LCM log, big-endian: sync word, event number (8), time (8), channel's length (4),
// data's length (4), channel, data. (lcm/eventlog.c)
inline constexpr std::uint32_t kLogSync = 0xEDA1DA01;
inline constexpr std::int64_t kLogHeaderBytes = 28;
inline constexpr std::int64_t kLogMaxChannelBytes = 255;   // LCM itself: 63
inline constexpr std::int64_t kLogMaxDataBytes = 1 << 28;  // LCM_MAX_MESSAGE_SIZE

}  // namespace rgbdt
