#include "services/bus/internal/datagram.h"

#include <algorithm>

namespace rgbdt {
namespace {

// Big-endian. A short message: magic (4), seq (4), channel, 0, data. A fragment: magic (4), seq
// (4), the message's bytes (4), offset (4), number (2), count (2), then number 0: channel, 0; data.
// (lcm/udpm_util.h)
constexpr std::uint32_t kShort = 0x4c433032;     // "LC02"
constexpr std::uint32_t kFragment = 0x4c433033;  // "LC03"
constexpr std::size_t kShortHeader = 8, kFragmentHeader = 20;

std::uint32_t BigEndian(const std::uint8_t* p, int bytes) {
  std::uint32_t value = 0;
  for (int i = 0; i < bytes; ++i) value = value << 8 | p[i];
  return value;
}

// Takes the channel and its 0 off the data's beginning.
bool TakeChannel(Datagram* datagram) {
  const std::uint8_t* begin = datagram->data;
  const std::uint8_t* end = begin + std::min(datagram->size, kMaxChannelBytes + 1);
  const std::uint8_t* zero = std::find(begin, end, 0);
  if (zero == end) return false;
  const auto length = static_cast<std::size_t>(zero - begin);
  datagram->channel = {reinterpret_cast<const char*>(begin), length};
  datagram->data += length + 1;
  datagram->size -= length + 1;
  return true;
}

// What is wrong with a fragment; its channel is taken off.
const char* FragmentProblem(const Datagram& fragment) {
  if (fragment.count == 0) return "a message of no fragments";
  if (fragment.number >= fragment.count) return "a fragment's number beyond their count";
  if (fragment.number == 0 && fragment.begin != 0) return "a first fragment not at the beginning";
  const bool within = fragment.begin <= fragment.message_bytes &&
                      fragment.size <= fragment.message_bytes - fragment.begin;
  return within ? nullptr : "a fragment beyond its message's end";
}

}  // namespace

std::optional<Datagram> ParseDatagram(const std::uint8_t* bytes, std::size_t size,
                                      const char** why) {
  const auto refuse = [&](const char* what) {
    *why = what;
    return std::nullopt;
  };
  if (size < kShortHeader) return refuse("shorter than LCM's header");
  const std::uint32_t magic = BigEndian(bytes, 4);
  if (magic != kShort && magic != kFragment) return refuse("not LCM's");
  Datagram datagram;
  datagram.is_fragment = magic == kFragment;
  const std::size_t header = datagram.is_fragment ? kFragmentHeader : kShortHeader;
  if (size < header) return refuse("shorter than a fragment's header");
  datagram.seq = BigEndian(bytes + 4, 4);
  datagram.data = bytes + header;
  datagram.size = size - header;
  if (datagram.is_fragment) {
    datagram.message_bytes = BigEndian(bytes + 8, 4);
    datagram.begin = BigEndian(bytes + 12, 4);
    datagram.number = BigEndian(bytes + 16, 2);
    datagram.count = BigEndian(bytes + 18, 2);
  }
  if (datagram.number == 0 && !TakeChannel(&datagram)) {
    return refuse("a channel's name that does not end within 63 characters");
  }
  if (datagram.is_fragment) *why = FragmentProblem(datagram);
  if (datagram.is_fragment && *why != nullptr) return std::nullopt;
  return datagram;
}

}  // namespace rgbdt
