#pragma once

#include <cctype>
#include <string>

namespace rgbdt {

/// The channel of a camera's images: RGB_IMAGE.
inline std::string ImageChannel(const std::string& camera) {
  std::string channel = camera;
  for (char& c : channel) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return channel + "_IMAGE";
}

/// Whether a channel carries a camera's images.
inline bool IsImageChannel(const std::string& channel) {
  const std::string end = "_IMAGE";
  return channel.size() > end.size() &&
         channel.compare(channel.size() - end.size(), end.size(), end) == 0;
}

}  // namespace rgbdt
