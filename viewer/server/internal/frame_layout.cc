#include "viewer/server/internal/frame_layout.h"

namespace rgbdt::viewer {
namespace {

constexpr std::size_t kFixedBytes = 8;

}  // namespace

std::size_t HeaderBytes(const std::string& frame) {
  std::uint32_t size = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    size |= std::uint32_t{static_cast<unsigned char>(frame[kIdBytes + i])} << (8 * i);
  }
  return kFixedBytes + size;
}

bool IsFrame(const std::string& frame) {
  return frame.size() >= kFixedBytes && HeaderBytes(frame) <= frame.size();
}

}  // namespace rgbdt::viewer
