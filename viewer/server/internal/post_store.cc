#include "viewer/server/internal/post_store.h"

#include <utility>

namespace rgbdt::viewer {
namespace {

constexpr std::size_t kMostClouds = 16;
constexpr std::size_t kMostOthers = 256;

}  // namespace

bool PostStore::Send(Post post) {
  const auto shared = std::make_shared<LazyPost>(std::move(post));
  const Post& sent = shared->post();
  const bool cloud = sent.record_bytes > 0;
  const std::lock_guard lock(mutex_);
  if (sent.kept) {
    kept_.Put(shared);
  } else {
    kept_.Erase(sent.topic);
  }
  const bool was_empty = sent_.empty();
  sent_.Put(shared);
  const auto like_it = [&](const Post& other) {
    return !kept_.Has(other.topic) && (other.record_bytes > 0) == cloud;
  };
  sent_.DropOldest(like_it, cloud ? kMostClouds : kMostOthers);
  return was_empty;
}

void PostStore::Forget(const std::string& topic_prefix) {
  const std::lock_guard lock(mutex_);
  kept_.EraseIf([&](const Post& post) { return post.topic.rfind(topic_prefix, 0) == 0; });
}

PostStore::Taken PostStore::Take() {
  const std::lock_guard lock(mutex_);
  Taken taken;
  taken.sent.assign(sent_.posts().begin(), sent_.posts().end());
  taken.kept.assign(kept_.posts().begin(), kept_.posts().end());
  sent_ = TopicQueue();
  return taken;
}

}  // namespace rgbdt::viewer
