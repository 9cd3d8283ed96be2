#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "calib/present/frames/session_frames.h"

namespace rgbdt::viewer {

/// The page as one HTML file, as the build made it; empty where it was built without Node.
std::string_view Page();

/// The page with frames in it: one file that opens without a server. `page` must not be empty.
std::string PageWithFrames(std::string_view page, const std::vector<NamedFrame>& frames);

}  // namespace rgbdt::viewer
