#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "viewer/server/channel_outbox.h"
#include "viewer/server/internal/lazy_bytes.h"

namespace rgbdt::viewer {

/// A message whose bytes are made for the first client that gets them.
struct LazyMessage {
  explicit LazyMessage(ChannelMessage sent)
      : message(std::move(sent)), payload(std::move(message.make)) {}
  ChannelMessage message;  ///< without `make`
  LazyBytes payload;
};
using SharedMessage = std::shared_ptr<LazyMessage>;

struct Channel {
  std::uint32_t id = 0;  ///< of no other channel, ever
  std::string topic, schema_name;
  std::shared_ptr<const std::string> schema;
  std::map<std::string, SharedMessage> holding;  ///< for those who subscribe later
};

/// A client of channels, on the server's thread.
class ChannelListener {
 public:
  virtual ~ChannelListener() = default;
  virtual void OnChannel(const Channel& channel) = 0;  ///< a new one
  virtual void OnEnd(const std::vector<std::uint32_t>& ids) = 0;
  virtual void OnMessage(std::uint32_t channel, const SharedMessage& message) = 0;
};

/// Where whoever publishes and the server's thread meet: what was published and not yet handed on,
/// the channels, and what holds in each. Of what waits the newest 256 stay, of what is large the
/// newest of its topic. 256 channels at most, and what holds for 64 names in each: more are
/// dropped.
class Channels {
 public:
  // In any thread. True: nothing waited before, so the server's thread is to be woken.
  bool Publish(ChannelMessage message);
  bool End();
  bool AnybodyListens() const { return listening_ > 0; }

  // On the server's thread.
  void Dispatch();
  void Join(ChannelListener* listener);
  void Leave(ChannelListener* listener);
  std::size_t listeners() const { return listeners_.size(); }
  const std::map<std::uint32_t, Channel>& all() const { return channels_; }  ///< by id

 private:
  bool Push(SharedMessage message);  // null: the channels end
  void DropWaiting(const ChannelMessage& newer);
  Channel* ChannelOf(const ChannelMessage& message);
  void EndAll();

  std::mutex mutex_;  // guards waiting_
  std::deque<SharedMessage> waiting_;
  std::atomic<std::size_t> listening_ = 0;
  std::vector<ChannelListener*> listeners_;
  std::uint32_t last_id_ = 0;
  std::map<std::uint32_t, Channel> channels_;
};

}  // namespace rgbdt::viewer
