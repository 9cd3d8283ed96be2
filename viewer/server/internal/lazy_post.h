#pragma once

#include <memory>
#include <string>
#include <utility>

#include "viewer/server/internal/lazy_bytes.h"
#include "viewer/server/internal/steady_seconds.h"
#include "viewer/server/outbox.h"

namespace rgbdt::viewer {

/// A post whose frame is made when it is first asked for, once for all browsers.
class LazyPost {
 public:
  explicit LazyPost(Post post)
      : post_(std::move(post)), frame_(std::move(post_.make)), sent_s_(SteadySeconds()) {}

  const Post& post() const { return post_; }  ///< without `make`
  double sent_s() const { return sent_s_; }   ///< of the steady clock [s]

  /// The frame; null where it could not be made. Only on the server's thread.
  std::shared_ptr<const std::string> Frame();

 private:
  Post post_;
  LazyBytes frame_;
  double sent_s_;
};

using SharedPost = std::shared_ptr<LazyPost>;

}  // namespace rgbdt::viewer
