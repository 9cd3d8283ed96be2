#include "services/bus/internal/reassembly.h"

#include <algorithm>

namespace rgbdt {
namespace {

constexpr std::size_t kMaxBytesHeld = std::size_t{64} << 20;
constexpr std::size_t kMaxSendersHeld = 256;

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
  if (!partial.message.Add(datagram) || partial.message.missing() != 0) return std::nullopt;
  std::optional<WholeMessage> message = partial.message.Take();
  if (!message) *why = "fragments that overlap, or leave a hole";
  Erase(found);
  return message;
}

Reassembly::Partials::iterator Reassembly::Find(const Sender& sender, const Datagram& fragment,
                                                const char** why) {
  const auto found = partial_.find(sender);
  if (found != partial_.end() && found->second.seq == fragment.seq) {
    if (found->second.message.Fits(fragment)) return found;
    *why = "a fragment of a message of another size than those before it";
    return partial_.end();
  }
  if (fragment.number != 0) return partial_.end();
  if (found != partial_.end()) Erase(found);
  return Begin(sender, fragment, why);
}

Reassembly::Partials::iterator Reassembly::Begin(const Sender& sender, const Datagram& fragment,
                                                 const char** why) {
  if (!is_wanted_(std::string(fragment.channel))) return partial_.end();
  *why = PartialMessage::TooLarge(fragment);
  if (*why != nullptr) return partial_.end();
  MakeRoom(fragment.message_bytes);
  bytes_held_ += fragment.message_bytes;
  return partial_.emplace(sender, Partial{fragment.seq, PartialMessage(fragment), 0}).first;
}

void Reassembly::Erase(Partials::iterator partial) {
  bytes_held_ -= partial->second.message.message_bytes();
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
