#include "viewer/server/internal/topic_queue.h"

#include <algorithm>

namespace rgbdt::viewer {

void TopicQueue::Put(SharedPost post) {
  const std::string& topic = post->post().topic;
  const auto found = places_.find(topic);
  if (found != places_.end()) {
    *found->second = std::move(post);
    return;
  }
  const Place place = posts_.insert(posts_.end(), post);
  places_.emplace(topic, place);
}

SharedPost TopicQueue::PopFront() {
  SharedPost post = posts_.front();
  Erase(posts_.begin());
  return post;
}

void TopicQueue::Erase(const std::string& topic) {
  const auto found = places_.find(topic);
  if (found != places_.end()) Erase(found->second);
}

TopicQueue::Place TopicQueue::Erase(Place place) {
  places_.erase((*place)->post().topic);
  return posts_.erase(place);
}

void TopicQueue::EraseIf(const Predicate& which) { DropOldest(which, 0); }

std::size_t TopicQueue::DropOldest(const Predicate& which, std::size_t most) {
  if (posts_.size() <= most) return 0;
  const std::size_t count = Count(which);
  const std::size_t drop = count > most ? count - most : 0;
  std::size_t dropped = 0;
  for (Place place = posts_.begin(); dropped < drop;) {
    if (which((*place)->post())) {
      place = Erase(place);
      ++dropped;
    } else {
      ++place;
    }
  }
  return dropped;
}

std::size_t TopicQueue::Count(const Predicate& which) const {
  return static_cast<std::size_t>(std::count_if(
      posts_.begin(), posts_.end(), [&](const SharedPost& post) { return which(post->post()); }));
}

}  // namespace rgbdt::viewer
