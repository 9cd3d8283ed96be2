#pragma once

#include <string>
#include <vector>

namespace rgbdt {

/// The command line of `import`; what each is stands at its option (verb_import.cc).
struct ImportFlags {
  std::string bag, board, out, log, session;
  std::vector<std::string> images, image_folders, clouds, lenses, at, metadata;
  bool pinhole = false, fisheye = false, in_order = false;
  double every_s = 0, max_apart_s = 0.1;
  int views = 24, port = 0;
};

}  // namespace rgbdt
