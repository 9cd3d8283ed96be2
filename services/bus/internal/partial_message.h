#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "services/bus/internal/datagram.h"
#include "services/bus/internal/message_memory.h"

namespace rgbdt {

/// A message as it was sent.
struct WholeMessage {
  std::string channel;
  MessageBytes bytes;
};

/// A long message of which fragments have come, in any order. Bytes take memory when they come, not
/// when a header speaks of them.
class PartialMessage {
 public:
  /// What is wrong with a message of these fragments, larger than a message may be; else null.
  static const char* TooLarge(const Datagram& fragment);

  /// Of the message that `fragment`, any of it, belongs to; not TooLarge.
  explicit PartialMessage(const Datagram& fragment);

  /// The message is of this size and in so many fragments.
  bool Fits(const Datagram& fragment) const {
    return message_bytes_ == fragment.message_bytes && fragments_.size() == fragment.count;
  }
  /// One that Fits. False: it had come.
  bool Add(const Datagram& fragment);

  std::uint32_t message_bytes() const { return message_bytes_; }
  /// At most, once all has come.
  std::size_t memory() const { return message_bytes_ + fragments_.size() * sizeof(Range); }
  std::size_t fragments() const { return fragments_.size(); }
  std::size_t missing() const { return missing_; }
  bool Has(std::size_t number) const { return fragments_[number].came; }
  /// Known with fragment 0.
  const std::optional<std::string>& channel() const { return channel_; }

  /// The message, once none is missing. Each of its bytes was sent, once: nothing where fragments
  /// overlap or leave a hole.
  std::optional<WholeMessage> Take();

 private:
  struct Range {
    std::uint32_t begin = 0, end = 0;
    bool came = false;
  };
  std::optional<std::string> channel_;
  std::uint32_t message_bytes_;
  std::vector<Range> fragments_;
  std::size_t missing_;
  MessageBytes bytes_;
};

}  // namespace rgbdt
