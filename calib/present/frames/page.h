#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace rgbdt {

/// A frame and what it is about ("session", "thumb/0001/rgb", ...), as a live session has them.
struct NamedFrame {
  std::string topic;
  std::string bytes;
};

/// The viewer's page as one HTML file, as the build made it; empty where it was built without Node.
std::string_view ViewerPage();

/// The page with frames in it: one file that opens without a server. `page` must not be empty.
/// Who opens it without JavaScript sees `plain_text` instead.
std::string PageWithFrames(std::string_view page, const std::vector<NamedFrame>& frames,
                           const std::string& plain_text);

}  // namespace rgbdt
