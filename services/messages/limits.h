#pragma once

#include <cstddef>
#include <cstdint>

namespace rgbdt {

// Limits that the .lcm files do not state; the same for sender and receiver.

/// No message is larger: LCM loses large messages first.
inline constexpr std::size_t kMaxMessageBytes = 3 * 1024 * 1024;
/// Times and numbers below 2^53 survive a double, so every language's tools can hold them.
inline constexpr std::int64_t kMaxInteger = std::int64_t{1} << 53;
/// [m]; nothing that a LIDAR sees is farther, and its square still is a finite float.
inline constexpr float kMaxMetres = 1e6F;
inline constexpr std::size_t kMaxNameBytes = 255;
inline constexpr std::size_t kMaxTextBytes = 64 * 1024;
inline constexpr int kMaxImageSide = 20000;  ///< [px]
/// A decoded BGR image of this many pixels takes 200 MB: the most that one message may cost.
inline constexpr std::int64_t kMaxPixels = std::int64_t{1} << 26;
inline constexpr std::int64_t kMaxLines = 1'000'000;  ///< of a sweep, and beams of a line
inline constexpr std::int64_t kMaxCameras = 32;       ///< of a rig: the bits of rgbdt_cloud_t.valid
inline constexpr std::int64_t kMaxCandidates = 100;   ///< a few are sent; each costs readers time
inline constexpr double kMaxTimeOffsetS = 60;         ///< of a camera's clock
inline constexpr std::int64_t kMaxCounters = 1000;    ///< of a process's status

}  // namespace rgbdt
