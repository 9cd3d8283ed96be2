#pragma once

#include <string>
#include <vector>

#include "calib/files/import/folders.h"

namespace rgbdt {

/// The command line of `session`; what each is stands at its option (verb_session.cc).
struct FolderFlags {
  std::vector<std::string> images, clouds, lenses;
  std::string board, out;
  bool pinhole = false, fisheye = false;
  PairOptions pairing;
};

/// Throws InputError for what makes no sense.
Folders FoldersOf(const FolderFlags& flags);

/// Makes the session directory `out`, for which RequireRoomForSession holds, and says what is in
/// it. Gives the exit code.
int MakeSession(const Folders& folders, const std::string& out);

}  // namespace rgbdt
