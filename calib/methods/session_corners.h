#pragma once

#include <string>
#include <vector>

#include "calib/files/session/session_dir.h"
#include "calib/methods/progress.h"
#include "calib/model/intrinsics.h"

namespace rgbdt {

struct SessionCorners {
  std::vector<CameraCorners> cameras;   ///< in the order asked for
  std::vector<std::string> unreadable;  ///< one line for each view that could not be read
};

/// Finds the checkerboard's inner corners in every image of these cameras, two or more views at a
/// time, with a line of progress for each. Clouds are not read. A view that cannot be
/// read is named, and the rest goes on. Throws InputError for a target without a pattern.
SessionCorners FindSessionCorners(const Session& session, const std::vector<std::string>& cameras,
                                  const Progress& progress);

}  // namespace rgbdt
