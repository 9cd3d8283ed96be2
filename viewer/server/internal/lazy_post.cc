#include "viewer/server/internal/lazy_post.h"

#include "viewer/server/internal/frame_layout.h"

namespace rgbdt::viewer {

std::shared_ptr<const std::string> LazyPost::Frame() {
  auto frame = frame_.Get();
  return frame && IsFrame(*frame) ? frame : nullptr;
}

}  // namespace rgbdt::viewer
