#include "services/bus/internal/reassembly.h"

#include <algorithm>

#include "services/messages/limits.h"

namespace rgbdt {
namespace {

constexpr std::size_t kMaxBytesHeld = std::size_t{64} << 20;
constexpr std::size_t kMaxSendersHeld = 256;
// A message of 3 MiB in the smallest fragments that an LCM sends (1423 bytes, on macOS) has 2211.
constexpr std::size_t kMaxFragments = 4096;

// Puts `data` at `begin`. In order, as they come as a rule, bytes are written once.
void Put(const std::uint8_t* data, std::size_t size, std::size_t begin, Bytes* bytes) {
  if (bytes->size() < begin) bytes->resize(begin);
  const std::size_t over = std::min(size, bytes->size() - begin);
  std::copy(data, data + over, bytes->begin() + static_cast<std::ptrdiff_t>(begin));
  bytes->insert(bytes->end(), data + over, data + size);
}

}  // namespace

std::optional<WholeMessage> Reassembly::Add(const Sender& sender, const Datagram& datagram,
                                            const char** why) {
  if (!datagram.is_fragment) {
    WholeMessage message{std::string(datagram.channel), {}};
    if (!is_wanted_(message.channel)) return std::nullopt;
    message.bytes.assign(datagram.data, datagram.data + datagram.size);
    return message;
  }
  const auto found = Find(sender, datagram, why);
  if (found == partial_.end()) return std::nullopt;
  Partial& partial = found->second;
  partial.touched = ++now_;
  Range& range = partial.fragments[datagram.number];
  if (range.came) return std::nullopt;
  range = {datagram.begin, datagram.begin + static_cast<std::uint32_t>(datagram.size), true};
  Put(datagram.data, datagram.size, datagram.begin, &partial.bytes);
  if (--partial.missing != 0) return std::nullopt;

  // Fragment by fragment: no hole, and nothing twice.
  std::uint32_t end = 0;
  bool whole = true;
  for (const Range& fragment : partial.fragments) {
    whole = whole && fragment.begin == end;
    end = fragment.end;
  }
  std::optional<WholeMessage> message;
  if (whole && end == partial.message_bytes) {
    message = WholeMessage{std::move(partial.channel), std::move(partial.bytes)};
  } else {
    *why = "fragments that overlap, or leave a hole";
  }
  Erase(found);
  return message;
}

Reassembly::Partials::iterator Reassembly::Find(const Sender& sender, const Datagram& fragment,
                                                const char** why) {
  const auto found = partial_.find(sender);
  if (found != partial_.end() && found->second.seq == fragment.seq) {
    const Partial& partial = found->second;
    if (partial.message_bytes == fragment.message_bytes &&
        partial.fragments.size() == fragment.count) {
      return found;
    }
    *why = "a fragment of a message of another size than those before it";
    return partial_.end();
  }
  if (fragment.number != 0) return partial_.end();
  if (found != partial_.end()) Erase(found);
  return Begin(sender, fragment, why);
}

Reassembly::Partials::iterator Reassembly::Begin(const Sender& sender, const Datagram& fragment,
                                                 const char** why) {
  std::string channel(fragment.channel);
  if (!is_wanted_(channel)) return partial_.end();
  if (fragment.message_bytes > kMaxMessageBytes || fragment.count > kMaxFragments) {
    *why = "a message larger than 3 MiB, or in more than 4096 fragments";
    return partial_.end();
  }
  MakeRoom(fragment.message_bytes);
  Partial partial;
  partial.channel = std::move(channel);
  partial.seq = fragment.seq;
  partial.message_bytes = fragment.message_bytes;
  partial.fragments.resize(fragment.count);
  partial.missing = fragment.count;
  partial.bytes.reserve(fragment.message_bytes);
  bytes_held_ += fragment.message_bytes;
  return partial_.emplace(sender, std::move(partial)).first;
}

void Reassembly::Erase(Partials::iterator partial) {
  bytes_held_ -= partial->second.message_bytes;
  partial_.erase(partial);
}

void Reassembly::MakeRoom(std::size_t bytes) {
  while (!partial_.empty() &&
         (bytes_held_ + bytes > kMaxBytesHeld || partial_.size() >= kMaxSendersHeld)) {
    Erase(std::min_element(partial_.begin(), partial_.end(), [](const auto& a, const auto& b) {
      return a.second.touched < b.second.touched;
    }));
  }
}

}  // namespace rgbdt
