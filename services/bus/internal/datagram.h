#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace rgbdt {

/// LCM's own, and ours.
inline constexpr std::size_t kMaxChannelBytes = 63;

/// A datagram of LCM: a short message, or a fragment of a long one. Views into the bytes that it
/// was read from.
struct Datagram {
  bool is_fragment = false;
  std::uint32_t seq = 0;     ///< of the sender's messages, on whatever channel
  std::string_view channel;  ///< of a short message and of a fragment 0
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;
  // Of a fragment; it lies within its message, and is one of its fragments.
  std::uint32_t message_bytes = 0;
  std::uint32_t begin = 0;  ///< where in the message `data` belongs
  std::uint32_t number = 0, count = 0;
};

/// Nothing where the bytes are no datagram of LCM; `why` then says what is wrong.
std::optional<Datagram> ParseDatagram(const std::uint8_t* bytes, std::size_t size,
                                      const char** why);

}  // namespace rgbdt
