#include "services/bus/internal/partial_message.h"

#include <algorithm>

#include "services/messages/limits.h"

namespace rgbdt {
namespace {

// A message of 3 MiB in the smallest fragments that an LCM sends (1423 bytes, on macOS) has 2211.
constexpr std::size_t kMaxFragments = 4096;

// Puts `data` at `begin`. In order, as they come as a rule, bytes are written once.
void Put(const std::uint8_t* data, std::size_t size, std::size_t begin, MessageBytes* bytes) {
  if (bytes->size() < begin) bytes->resize(begin);
  const std::size_t over = std::min(size, bytes->size() - begin);
  std::copy(data, data + over, bytes->begin() + static_cast<std::ptrdiff_t>(begin));
  bytes->insert(bytes->end(), data + over, data + size);
}

}  // namespace

const char* PartialMessage::TooLarge(const Datagram& fragment) {
  const bool too_large =
      fragment.message_bytes > kMaxMessageBytes || fragment.count > kMaxFragments;
  return too_large ? "a message larger than 3 MiB, or in more than 4096 fragments" : nullptr;
}

PartialMessage::PartialMessage(const Datagram& fragment)
    : message_bytes_(fragment.message_bytes), fragments_(fragment.count), missing_(fragment.count) {
  bytes_.reserve(fragment.message_bytes);
}

bool PartialMessage::Add(const Datagram& fragment) {
  Range& range = fragments_[fragment.number];
  if (range.came) return false;
  range = {fragment.begin, fragment.begin + static_cast<std::uint32_t>(fragment.size), true};
  if (fragment.number == 0) channel_ = std::string(fragment.channel);
  Put(fragment.data, fragment.size, fragment.begin, &bytes_);
  --missing_;
  return true;
}

// Fragment by fragment: no hole, and nothing twice.
std::optional<WholeMessage> PartialMessage::Take() {
  std::uint32_t end = 0;
  bool whole = channel_.has_value();
  for (const Range& fragment : fragments_) {
    whole = whole && fragment.begin == end;
    end = fragment.end;
  }
  if (!whole || end != message_bytes_) return std::nullopt;
  return WholeMessage{std::move(*channel_), std::move(bytes_)};
}

}  // namespace rgbdt
