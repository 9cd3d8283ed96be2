#pragma once

#include <functional>
#include <memory>
#include <string>

namespace rgbdt::viewer {

/// Something to show, on its way to browsers.
struct Post {
  /// A newer post takes the place of one of the same topic that was not yet sent. Topics are paths:
  /// "session", "thumb/0001/rgb", "sweep/0".
  std::string topic;
  /// Only for browsers that watch this: "" everybody, "cloud", "camera/rgb", "overlay/rgb".
  std::string watch;
  /// Whoever comes later gets it, too, while no newer one of its topic took its place.
  bool kept = true;
  /// Large: waits until the browser has drawn what was sent before; then the newest goes first and
  /// the oldest are dropped.
  bool heavy = false;
  /// Bytes of a record at the frame's end; 0: it cannot be thinned.
  std::size_t record_bytes = 0;
  /// The frame; made when the first browser is about to get it, once, and not at all if none does.
  /// An exception drops the post.
  std::function<std::string()> make;
  /// From when it was sent to the browser's ack is the time to the screen.
  bool timed = false;
};

/// Where posts go. Thread-safe; never blocks.
class Outbox {
 public:
  virtual ~Outbox() = default;
  virtual void Send(Post post) = 0;
  /// Kept posts whose topic begins so are forgotten.
  virtual void Forget(const std::string& topic_prefix) = 0;
};

}  // namespace rgbdt::viewer
