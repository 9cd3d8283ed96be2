#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

namespace rgbdt::viewer {

// What browsers, and what claims to be one, may take of this machine.

inline constexpr std::size_t kMaxBrowsers = 64;
/// More are told that there are too many, by a WebSocket of their own; beyond this by a 503.
inline constexpr std::size_t kMaxWebSockets = 96;
/// That are not yet, or never, browsers. One more takes the place of the oldest of them, so that
/// who holds connections open without a request keeps nobody out.
inline constexpr std::size_t kMaxHttpConnections = 64;
inline constexpr std::uint32_t kMaxHeaderBytes = 8 * 1024;

inline constexpr std::chrono::seconds kRequestTime{10};  ///< TLS and a request's header
inline constexpr std::chrono::seconds kAnswerTime{30};   ///< until the page was taken
inline constexpr std::chrono::seconds kDrainTime{2};     ///< for what comes behind a request
inline constexpr std::chrono::seconds kHandshakeTime{10};
inline constexpr std::chrono::seconds kHelloTime{10};  ///< from the WebSocket to the page's hello
inline constexpr std::chrono::seconds kIdleTime{60};   ///< without a sign of life
inline constexpr std::chrono::seconds kCloseTime{5};

inline constexpr std::size_t kMaxMessageText = 64 * 1024;  ///< [byte] in however many fragments
inline constexpr std::size_t kMaxMessageString = 200;      ///< [byte] names and tokens

/// [byte] of a browser in a second: a page says some hundred. In fragments of a byte more would
/// keep a core busy; who sends more waits.
inline constexpr std::size_t kMaxReadPerSecond = 16 * 1024;

/// The server's thread gives way to the bus', whatever browsers do (nice(2)).
inline constexpr int kNiceness = 10;

}  // namespace rgbdt::viewer
