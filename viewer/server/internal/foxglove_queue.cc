#include "viewer/server/internal/foxglove_queue.h"

#include <algorithm>
#include <utility>

#include "viewer/server/internal/foxglove_protocol.h"

namespace rgbdt::viewer {

bool FoxgloveQueue::Say(std::string text) {
  if (texts_.size() >= kMostTexts) return false;
  texts_.push_back(std::move(text));
  return true;
}

void FoxgloveQueue::Offer(std::uint32_t subscription, SharedMessage message) {
  const auto same = [&](const Waiting& waiting) { return waiting.subscription == subscription; };
  const std::size_t most = message->message.large ? 1 : kMostSmall;
  const auto waiting = std::count_if(messages_.begin(), messages_.end(), same);
  if (static_cast<std::size_t>(waiting) >= most) {
    messages_.erase(std::find_if(messages_.begin(), messages_.end(), same));
    ++dropped_;
  }
  messages_.push_back({subscription, std::move(message)});
}

void FoxgloveQueue::Drop(std::uint32_t subscription) {
  const auto same = [&](const Waiting& waiting) { return waiting.subscription == subscription; };
  messages_.erase(std::remove_if(messages_.begin(), messages_.end(), same), messages_.end());
}

std::optional<FoxgloveQueue::Outgoing> FoxgloveQueue::Next() {
  if (!texts_.empty()) {
    Outgoing text{true, std::move(texts_.front()), nullptr};
    texts_.pop_front();
    return text;
  }
  while (!messages_.empty()) {
    const Waiting next = std::move(messages_.front());
    messages_.pop_front();
    auto payload = next.message->payload.Get();
    if (!payload) continue;
    return Outgoing{false, MessageHead(next.subscription, next.message->message.utime),
                    std::move(payload)};
  }
  return std::nullopt;
}

}  // namespace rgbdt::viewer
