#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "services/foxglove/stream/foxglove_stream.h"
#include "services/messages/bytes.h"
#include "services/messages/message.h"
#include "viewer/server/channel_outbox.h"

namespace rgbdt::viewer {

/// What is on the bus for Foxglove's clients, as foxglove_stream.h has it: what `rgbdt export
/// --mcap` writes, live. Transforms and lenses hold for who subscribes later. Nothing large is kept
/// or made while nobody listens. Another rig's channels are new ones. All on the bus' thread.
class FoxgloveFeed {
 public:
  /// `outbox` outlives it.
  explicit FoxgloveFeed(ChannelOutbox* outbox);

  /// A message's bytes, before Take is called with it: an image that was sent as a file goes on as
  /// it came.
  void Overhear(const std::string& channel, const std::uint8_t* data, std::size_t size);
  /// `received` [us]: the machine's wall clock. Throws InputError for what cannot be used.
  void Take(const Message& message, Utime received);

 private:
  void Publish(FoxgloveMessage message);

  ChannelOutbox* outbox_;
  FoxgloveStream stream_;
  std::shared_ptr<const std::string> schema_;  // of all types: they are of one file
  std::string rig_hash_;
  Utime received_ = 0;
  std::string overheard_channel_;
  Bytes overheard_;  // an image's message
};

}  // namespace rgbdt::viewer
