#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "viewer/server/internal/topic_queue.h"

namespace rgbdt::viewer {

/// Where whoever sends and the server's thread meet: what was sent and not yet taken, and what is
/// kept for those who come later. Thread-safe. Holds one post a topic; of those that are not kept,
/// whose topics nothing bounds, it holds the newest 16 clouds and 256 others.
class PostStore {
 public:
  /// True: nothing waited before, so the server's thread is to be woken.
  bool Send(Post post);
  void Forget(const std::string& topic_prefix);

  struct Taken {
    std::vector<SharedPost> sent;  ///< since the last time
    std::vector<SharedPost> kept;  ///< all, in the order in which they were first sent
  };
  /// Both of one moment: what is in `kept` is not taken as `sent` later.
  Taken Take();

 private:
  std::mutex mutex_;
  TopicQueue sent_;
  TopicQueue kept_;
};

}  // namespace rgbdt::viewer
