#include "viewer/server/internal/foxglove_client.h"

#include <utility>

namespace rgbdt::viewer {
namespace {

constexpr std::size_t kMostWarnings = 16;  // that wait for who does not read

}  // namespace

FoxgloveClient::FoxgloveClient(Stream stream, Hub* hub) : WebSocket(std::move(stream), hub) {
  if (one_too_many()) return;
  ChannelListener* const listener = this;
  hub->channels.Join(listener);
  LeaveBy([listener, hub] { hub->channels.Leave(listener); });
}

void FoxgloveClient::OnOpen() {
  hub()->channels.Dispatch();  // what is new by now comes in the first list
  open_ = true;
  Say(ServerInfoText("rgbdt"));
  std::vector<const Channel*> all;
  for (const auto& [id, channel] : hub()->channels.all()) all.push_back(&channel);
  Say(AdvertiseText(all));
}

void FoxgloveClient::OnText(const std::string& text) {
  const FoxgloveRequest request = ParseFoxgloveRequest(text);
  switch (request.kind) {
    case FoxgloveRequest::Kind::kSubscribe:
      hub()->channels.Dispatch();  // so that nothing comes twice
      for (const auto& wanted : request.subscriptions) Subscribe(wanted);
      break;
    case FoxgloveRequest::Kind::kUnsubscribe:
      for (const std::uint32_t id : request.ids) Unsubscribe(id);
      break;
    case FoxgloveRequest::Kind::kOther:
      Warn("\"" + request.op + "\" is not offered here: there is only to be looked at");
      break;
  }
  Pump();
}

void FoxgloveClient::Subscribe(const FoxgloveRequest::Subscription& wanted) {
  const auto& channels = hub()->channels.all();
  const auto channel = channels.find(wanted.channel);
  if (channel == channels.end()) {
    return Warn("there is no channel " + std::to_string(wanted.channel));
  }
  if (channel_of_.count(wanted.id) != 0 || subscription_of_.count(wanted.channel) != 0) {
    return Warn("subscription " + std::to_string(wanted.id) + " to channel " +
                std::to_string(wanted.channel) + ": there is one already");
  }
  channel_of_[wanted.id] = wanted.channel;
  subscription_of_[wanted.channel] = wanted.id;
  for (const auto& [name, message] : channel->second.holding) queue_.Offer(wanted.id, message);
}

void FoxgloveClient::Unsubscribe(std::uint32_t id) {
  const auto found = channel_of_.find(id);
  if (found == channel_of_.end()) return;
  subscription_of_.erase(found->second);
  channel_of_.erase(found);
  queue_.Drop(id);
}

void FoxgloveClient::OnChannel(const Channel& channel) {
  if (open_) Say(AdvertiseText({&channel}));
}

void FoxgloveClient::OnEnd(const std::vector<std::uint32_t>& ids) {
  for (const auto& [id, channel] : channel_of_) queue_.Drop(id);
  channel_of_.clear();
  subscription_of_.clear();
  if (open_) Say(UnadvertiseText(ids));
}

void FoxgloveClient::OnMessage(std::uint32_t channel, const SharedMessage& message) {
  const auto subscription = subscription_of_.find(channel);
  if (subscription == subscription_of_.end()) return;
  queue_.Offer(subscription->second, message);
  Pump();
}

void FoxgloveClient::Say(std::string text) {
  if (!queue_.Say(std::move(text))) Close(CloseCode::policy_error, "it reads nothing");
  Pump();
}

void FoxgloveClient::Warn(const std::string& warning) {
  if (queue_.texts() < kMostWarnings) Say(WarningText(warning));
}

void FoxgloveClient::Pump() {
  std::optional<FoxgloveQueue::Outgoing> next;
  if (may_write()) next = queue_.Next();
  Tell(queue_.waiting(), queue_.dropped(), 1);
  if (!next) return;
  outgoing_ = std::move(*next);
  std::array<net::const_buffer, 2> buffers = {net::buffer(outgoing_.head), net::const_buffer()};
  if (outgoing_.payload) buffers[1] = net::buffer(*outgoing_.payload);
  Write(buffers, outgoing_.is_text);
}

void FoxgloveClient::OnWritten() {
  outgoing_ = {};
  Pump();
}

}  // namespace rgbdt::viewer
