#pragma once

#include <string>

namespace rgbdt {

/// Whether a channel carries a camera's images: RGB_IMAGE (see ChannelOf).
inline bool IsImageChannel(const std::string& channel) {
  const std::string end = "_IMAGE";
  return channel.size() > end.size() &&
         channel.compare(channel.size() - end.size(), end.size(), end) == 0;
}

}  // namespace rgbdt
