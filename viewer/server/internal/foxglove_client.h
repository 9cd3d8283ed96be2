#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "viewer/server/internal/foxglove_protocol.h"
#include "viewer/server/internal/foxglove_queue.h"
#include "viewer/server/internal/web_socket.h"

namespace rgbdt::viewer {

/// A client that speaks Foxglove's protocol: is told of the channels, subscribes, and gets their
/// messages. What it asks for beyond that is answered by a warning.
class FoxgloveClient final : public WebSocket, private ChannelListener {
 public:
  FoxgloveClient(Stream stream, Hub* hub);

 private:
  void OnOpen() override;
  void OnText(const std::string& text) override;
  void OnWritten() override;
  void OnChannel(const Channel& channel) override;
  void OnEnd(const std::vector<std::uint32_t>& ids) override;
  void OnMessage(std::uint32_t channel, const SharedMessage& message) override;

  void Subscribe(const FoxgloveRequest::Subscription& wanted);
  void Unsubscribe(std::uint32_t id);
  void Say(std::string text);
  void Warn(const std::string& warning);
  void Pump();

  bool open_ = false;
  std::map<std::uint32_t, std::uint32_t> channel_of_;       // by subscription
  std::map<std::uint32_t, std::uint32_t> subscription_of_;  // by channel
  FoxgloveQueue queue_;
  FoxgloveQueue::Outgoing outgoing_;  // being written
};

}  // namespace rgbdt::viewer
