#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "viewer/server/internal/channels.h"

namespace rgbdt::viewer {

/// What waits for one of Foxglove's clients: texts of the protocol first, then messages in the
/// order in which they came. A client that reads slowly loses whole messages: of a subscription the
/// newest stays of what is large, and the newest 64 of what is not.
class FoxgloveQueue {
 public:
  static constexpr std::size_t kMostSmall = 64;
  static constexpr std::size_t kMostTexts = 1000;

  /// False: it takes no more; the client reads nothing.
  bool Say(std::string text);
  std::size_t texts() const { return texts_.size(); }
  void Offer(std::uint32_t subscription, SharedMessage message);
  void Drop(std::uint32_t subscription);  ///< what waits of it

  struct Outgoing {
    bool is_text = false;
    std::string head;  ///< the text, or what stands before a message's bytes
    std::shared_ptr<const std::string> payload;
  };
  /// Empty: nothing waits. Makes a message's bytes.
  std::optional<Outgoing> Next();

  std::size_t waiting() const { return texts_.size() + messages_.size(); }
  std::int64_t dropped() const { return dropped_; }

 private:
  struct Waiting {
    std::uint32_t subscription;
    SharedMessage message;
  };

  std::deque<std::string> texts_;
  std::deque<Waiting> messages_;
  std::int64_t dropped_ = 0;
};

}  // namespace rgbdt::viewer
