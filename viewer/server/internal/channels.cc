#include "viewer/server/internal/channels.h"

#include <algorithm>
#include <utility>

namespace rgbdt::viewer {
namespace {

constexpr std::size_t kMostWaiting = 256;
constexpr std::size_t kMostChannels = 256;
constexpr std::size_t kMostHolding = 64;

}  // namespace

bool Channels::Publish(ChannelMessage message) {
  return Push(std::make_shared<LazyMessage>(std::move(message)));
}

bool Channels::End() { return Push(nullptr); }

bool Channels::Push(SharedMessage message) {
  const std::lock_guard lock(mutex_);
  const bool was_empty = waiting_.empty();
  if (message) DropWaiting(message->message);
  waiting_.push_back(std::move(message));
  return was_empty;
}

void Channels::DropWaiting(const ChannelMessage& newer) {
  const auto drop_first = [&](const auto& dropped) {
    const auto found = std::find_if(waiting_.begin(), waiting_.end(), dropped);
    if (found != waiting_.end()) waiting_.erase(found);
  };
  if (newer.large) {
    drop_first([&](const SharedMessage& m) { return m && m->message.topic == newer.topic; });
  }
  if (waiting_.size() < kMostWaiting) return;
  drop_first([](const SharedMessage& m) { return m && m->message.holds_for.empty(); });
  if (waiting_.size() >= kMostWaiting) waiting_.pop_front();
}

void Channels::Dispatch() {
  std::deque<SharedMessage> sent;
  {
    const std::lock_guard lock(mutex_);
    sent.swap(waiting_);
  }
  for (const SharedMessage& shared : sent) {
    if (!shared) {
      EndAll();
      continue;
    }
    const ChannelMessage& message = shared->message;
    Channel* channel = ChannelOf(message);
    if (channel == nullptr) continue;
    if (!message.holds_for.empty()) {
      auto& holding = channel->holding;
      if (holding.size() >= kMostHolding && holding.count(message.holds_for) == 0) continue;
      holding[message.holds_for] = shared;
    }
    for (ChannelListener* listener : listeners_) listener->OnMessage(channel->id, shared);
  }
}

// Null: there are too many, or the topic has another type.
Channel* Channels::ChannelOf(const ChannelMessage& message) {
  const auto found = std::find_if(channels_.begin(), channels_.end(), [&](const auto& channel) {
    return channel.second.topic == message.topic;
  });
  if (found != channels_.end()) {
    return found->second.schema_name == message.schema_name ? &found->second : nullptr;
  }
  if (channels_.size() >= kMostChannels || !message.schema) return nullptr;
  const std::uint32_t id = ++last_id_;
  Channel& channel = channels_[id];
  channel = {id, message.topic, message.schema_name, message.schema, {}};
  for (ChannelListener* listener : listeners_) listener->OnChannel(channel);
  return &channel;
}

void Channels::EndAll() {
  std::vector<std::uint32_t> ids;
  for (const auto& [id, channel] : channels_) ids.push_back(id);
  channels_.clear();
  if (ids.empty()) return;
  for (ChannelListener* listener : listeners_) listener->OnEnd(ids);
}

void Channels::Join(ChannelListener* listener) {
  listeners_.push_back(listener);
  listening_ = listeners_.size();
}

void Channels::Leave(ChannelListener* listener) {
  listeners_.erase(std::remove(listeners_.begin(), listeners_.end(), listener), listeners_.end());
  listening_ = listeners_.size();
}

}  // namespace rgbdt::viewer
