#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace rgbdt::viewer {

/// A message of a channel, on its way to clients that speak Foxglove's protocol.
struct ChannelMessage {
  std::string topic;        ///< "/lidar/points"; the channel begins with its first
  std::string schema_name;  ///< "foxglove.PointCloud"
  std::shared_ptr<const std::string> schema;  ///< a FileDescriptorSet
  std::int64_t utime = 0;                     ///< when it was received [us]
  /// Whoever subscribes later gets it, too, while none of the same topic and name took its place.
  /// Empty: it is for those who listen now.
  std::string holds_for;
  /// An image or a cloud: of those that wait for a client the newest stays.
  bool large = false;
  /// Its bytes; made when the first client is about to get it, once, and not at all if none does.
  /// An exception drops the message.
  std::function<std::string()> make;
};

/// Where they go. Thread-safe; never blocks.
class ChannelOutbox {
 public:
  virtual ~ChannelOutbox() = default;
  virtual void Publish(ChannelMessage message) = 0;
  /// All channels end, and what held with them: what comes next begins new ones.
  virtual void EndChannels() = 0;
  /// Whether there is any client: without one nothing large is worth making.
  virtual bool AnybodyListens() const = 0;
};

}  // namespace rgbdt::viewer
