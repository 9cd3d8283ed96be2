#pragma once

#include <string>
#include <vector>

#include "services/bus/internal/message_memory.h"
#include "services/messages/bytes.h"

namespace rgbdt::test {

/// Bytes that have arrived, to compare them.
inline Bytes Arrived(const MessageBytes& bytes) { return {bytes.begin(), bytes.end()}; }

inline void AddBigEndian(std::uint32_t value, int bytes, Bytes* to) {
  while (bytes-- > 0) to->push_back(static_cast<std::uint8_t>(value >> 8 * bytes));
}

inline void AddText(const std::string& text, Bytes* to) {
  to->insert(to->end(), text.begin(), text.end());
}

/// LCM's short message. `channel` with the 0 at its end, or whatever stands there.
inline Bytes ShortDatagram(std::uint32_t seq, const std::string& channel, const Bytes& data) {
  Bytes bytes;
  AddText("LC02", &bytes);
  AddBigEndian(seq, 4, &bytes);
  AddText(channel, &bytes);
  bytes.insert(bytes.end(), data.begin(), data.end());
  return bytes;
}

/// A fragment of LCM's long message; `text` before its data.
struct Fragment {
  std::uint32_t seq, message_bytes, begin, number, count;
  std::string text;
  Bytes data;

  Bytes Datagram() const {
    Bytes bytes;
    AddText("LC03", &bytes);
    AddBigEndian(seq, 4, &bytes);
    AddBigEndian(message_bytes, 4, &bytes);
    AddBigEndian(begin, 4, &bytes);
    AddBigEndian(number, 2, &bytes);
    AddBigEndian(count, 2, &bytes);
    AddText(text, &bytes);
    bytes.insert(bytes.end(), data.begin(), data.end());
    return bytes;
  }
};

/// One sender's datagrams, of which the last is to be refused, and why.
struct Attack {
  std::string why;  ///< a part of what is said
  std::vector<Bytes> datagrams;
};

/// Of what is wrong with each LCM 1.3.1 sees some; it dies of the first, of a fragment's header cut
/// short and of a channel without an end.
inline std::vector<Attack> Attacks(const std::string& channel) {
  std::uint32_t seq = 1000;
  const std::string name = channel + std::string(1, '\0');
  const Bytes some(100, 7);
  const auto begun = [&](std::uint32_t bytes, std::uint32_t count) {
    return Fragment{++seq, bytes, 0, 0, count, name, some}.Datagram();
  };
  const auto then = [&](std::uint32_t bytes, std::uint32_t begin, std::uint32_t number,
                        std::uint32_t count) {
    return Fragment{seq, bytes, begin, number, count, "", some}.Datagram();
  };
  const auto first = [&](std::uint32_t bytes, std::uint32_t begin, const std::string& text) {
    return Fragment{++seq, bytes, begin, 0, 2, text, some}.Datagram();
  };
  const auto cut = [](Bytes bytes, std::size_t size) {
    bytes.resize(size);
    return bytes;
  };
  std::vector<Attack> attacks;
  const std::string beyond = "beyond its message's end", ends = "does not end within 63";
  attacks.push_back({beyond, {begun(1000, 3), then(1000, 0xfffffff0, 1, 3)}});
  attacks.push_back({beyond, {begun(1000, 3), then(1000, 950, 1, 3)}});
  attacks.push_back({beyond, {begun(1000, 3), then(1000, 5000, 1, 3)}});
  attacks.push_back({beyond, {begun(0, 1)}});
  attacks.push_back({"shorter than LCM", {{}}});
  attacks.push_back({"shorter than LCM", {cut(begun(1000, 3), 7)}});
  attacks.push_back({"shorter than a frag", {begun(1000, 3), cut(then(1000, 12, 1, 3), 8)}});
  attacks.push_back({"shorter than a frag", {begun(1000, 3), cut(then(1000, 12, 1, 3), 19)}});
  attacks.push_back({"not LCM's", {Bytes(200, 'X')}});
  attacks.push_back({ends, {ShortDatagram(1, name, some), cut(ShortDatagram(2, name, {}), 9)}});
  attacks.push_back({ends, {ShortDatagram(3, std::string(64, 'A'), {0})}});
  attacks.push_back({ends, {first(1000, 0, std::string(64, 'A'))}});
  attacks.push_back(
      {ends, {cut(first(1000, static_cast<std::uint32_t>(channel.size()), name), 21)}});
  attacks.push_back({"no fragments", {begun(1000, 0)}});
  attacks.push_back({"beyond their count", {begun(1000, 3), then(1000, 100, 3, 3)}});
  attacks.push_back({"not at the beginning", {first(1000, 0xfffffff0, name)}});
  attacks.push_back({"larger than 3 MiB", {begun(0xffffffff, 3)}});
  attacks.push_back({"larger than 3 MiB", {begun(1 << 28, 3)}});
  attacks.push_back({"of another size", {begun(1000, 3), then(9000, 8000, 1, 3)}});
  attacks.push_back({"of another size", {begun(1000, 3), then(1000, 100, 1, 9)}});
  attacks.push_back({"leave a hole", {begun(300, 3), then(300, 50, 1, 3), then(300, 200, 2, 3)}});
  attacks.push_back({"leave a hole", {begun(0xfffff, 1)}});
  return attacks;
}

}  // namespace rgbdt::test
