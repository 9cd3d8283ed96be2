#include "viewer/live/foxglove_feed.h"

#include <utility>
#include <variant>

#include "services/messages/codec.h"
#include "services/messages/image_channel.h"

namespace rgbdt::viewer {
namespace {

bool IsLarge(const Message& message) {
  return std::holds_alternative<Image>(message) || std::holds_alternative<CloudChunk>(message) ||
         std::holds_alternative<RgbdtCloud>(message);
}

}  // namespace

FoxgloveFeed::FoxgloveFeed(ChannelOutbox* outbox)
    : outbox_(outbox),
      stream_({}, [this](FoxgloveMessage message) { Publish(std::move(message)); }),
      schema_(std::make_shared<const std::string>(
          DescribeSchema(*foxglove::PointCloud::descriptor()))) {}

void FoxgloveFeed::Overhear(const std::string& channel, const std::uint8_t* data,
                            std::size_t size) {
  overheard_.clear();
  if (!IsImageChannel(channel) || !outbox_->AnybodyListens()) return;
  overheard_channel_ = channel;
  overheard_.assign(data, data + size);
}

void FoxgloveFeed::Take(const Message& message, Utime received) {
  const Bytes overheard = std::exchange(overheard_, {});
  if (IsLarge(message) && !outbox_->AnybodyListens()) return;
  received_ = received;
  if (const auto* rig = std::get_if<RigText>(&message)) {
    if (!rig_hash_.empty() && rig_hash_ != rig->hash) outbox_->EndChannels();
    rig_hash_ = rig->hash;
  }
  const bool is_its_own = !overheard.empty() && ChannelOf(message) == overheard_channel_;
  stream_.Take(message, is_its_own ? ImageFileOf(overheard.data(), overheard.size()) : Bytes());
}

void FoxgloveFeed::Publish(FoxgloveMessage message) {
  ChannelMessage out;
  out.topic = std::move(message.topic);
  out.schema_name = message.schema->full_name();
  out.schema = schema_;
  out.utime = received_;
  out.holds_for = std::move(message.holds_for);
  out.large = message.large;
  out.make = std::move(message.serialize);
  outbox_->Publish(std::move(out));
}

}  // namespace rgbdt::viewer
