#include "viewer/server/internal/lazy_bytes.h"

namespace rgbdt::viewer {

std::shared_ptr<const std::string> LazyBytes::Get() {
  if (!make_) return bytes_;
  const auto make = std::exchange(make_, nullptr);  // what it holds may be larger than the bytes
  try {
    bytes_ = std::make_shared<const std::string>(make());
  } catch (...) {  // whatever a maker throws costs these bytes only
  }
  return bytes_;
}

}  // namespace rgbdt::viewer
