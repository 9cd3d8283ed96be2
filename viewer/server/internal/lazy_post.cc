#include "viewer/server/internal/lazy_post.h"

#include "viewer/server/internal/frame_layout.h"

namespace rgbdt::viewer {
namespace {

std::shared_ptr<const std::string> Made(const Post& post) {
  if (!post.make) return nullptr;
  try {
    auto frame = std::make_shared<const std::string>(post.make());
    return IsFrame(*frame) ? frame : nullptr;
  } catch (...) {  // whatever a maker throws costs this post only
    return nullptr;
  }
}

}  // namespace

std::shared_ptr<const std::string> LazyPost::Frame() {
  if (asked_) return frame_;
  asked_ = true;
  frame_ = Made(post_);
  post_.make = nullptr;  // what it was made of may be larger than the frame
  return frame_;
}

}  // namespace rgbdt::viewer
