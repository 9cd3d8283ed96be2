#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "viewer/server/internal/thinning.h"
#include "viewer/server/internal/topic_queue.h"

namespace rgbdt::viewer {

/// What waits for one browser, and what it is sent next. Light posts go first, all of them. Heavy
/// ones go in the order in which they came, while the browser owes acks for less than 4 MB and for
/// at most 3 of them, or more that are less than 1 MB together. What waits is bounded: one post a
/// topic, 8 clouds, 256 others that are not kept and 4096 that are. Kept clouds that were cut go
/// again, with all that the browser draws, once nothing else waits and all is drawn: a picture at
/// rest is whole.
class BrowserQueue {
 public:
  /// What the browser looks at, and the most points that it draws of a sweep. What it does not look
  /// at any more is dropped. Gives what it did not look at before.
  std::set<std::string> Watch(std::set<std::string> keys, std::int64_t points);
  void Offer(SharedPost post);   ///< as it comes; skipped where it is not watched
  void Replay(SharedPost post);  ///< a kept one; nothing is dropped for it

  struct Outgoing {
    std::uint32_t id = 0;
    std::shared_ptr<const std::string> frame;
    std::size_t bytes = 0;  ///< the first of the frame: the rest is thinned away
  };
  /// Empty: nothing waits, or acks must come first. Makes the frame.
  std::optional<Outgoing> Next();

  /// When the frame's post was sent [s, steady clock]; empty where that is not timed, and for ids
  /// that no ack is awaited of.
  std::optional<double> Acked(std::uint32_t id);

  std::size_t waiting() const { return light_.size() + heavy_.size(); }
  std::int64_t thinned() const { return thinned_; }
  double share() const { return thinning_.share(); }

 private:
  struct Unacked {
    std::size_t bytes = 0;
    std::optional<double> sent_s;  // nothing: not timed
  };
  bool Watches(const std::string& key) const { return key.empty() || watched_.count(key) != 0; }
  void DropBeyond(TopicQueue* queue);
  bool MaySendHeavy() const;
  std::optional<Outgoing> Outgo(const SharedPost& post);
  std::optional<Outgoing> OutgoWhole();
  std::size_t CutBytes(const SharedPost& shared, const std::string& frame);

  std::set<std::string> watched_;
  TopicQueue light_, heavy_;
  TopicQueue cut_;  // kept clouds that were sent in part
  Thinning thinning_;
  std::int64_t thinned_ = 0;
  std::uint32_t last_id_ = 0;
  std::map<std::uint32_t, Unacked> unacked_;
  std::size_t unacked_bytes_ = 0;
};

}  // namespace rgbdt::viewer
