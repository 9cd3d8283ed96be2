#pragma once

#include <functional>
#include <list>
#include <string>
#include <unordered_map>

#include "viewer/server/internal/lazy_post.h"

namespace rgbdt::viewer {

/// Posts in the order in which their topics came, one a topic: a newer one takes the older one's
/// place in the row.
class TopicQueue {
 public:
  using Predicate = std::function<bool(const Post& post)>;

  TopicQueue() = default;
  TopicQueue(TopicQueue&&) = default;  // a copy would point into the original
  TopicQueue& operator=(TopicQueue&&) = default;

  void Put(SharedPost post);
  SharedPost PopFront();  ///< must not be empty
  void Erase(const std::string& topic);
  void EraseIf(const Predicate& which);
  /// Drops the oldest of those until `most` are left; how many were dropped.
  std::size_t DropOldest(const Predicate& which, std::size_t most);

  std::size_t Count(const Predicate& which) const;
  bool Has(const std::string& topic) const { return places_.count(topic) != 0; }
  std::size_t size() const { return posts_.size(); }
  bool empty() const { return posts_.empty(); }
  const std::list<SharedPost>& posts() const { return posts_; }

 private:
  using Place = std::list<SharedPost>::iterator;
  Place Erase(Place place);

  std::list<SharedPost> posts_;
  std::unordered_map<std::string, Place> places_;
};

}  // namespace rgbdt::viewer
