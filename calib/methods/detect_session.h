#pragma once

#include <string>
#include <vector>

#include "calib/files/session/session_dir.h"
#include "calib/methods/progress.h"
#include "calib/model/view_detection.h"

namespace rgbdt {

struct SessionDetection {
  std::vector<ViewDetection> views;     ///< in the session's order
  std::vector<std::string> unreadable;  ///< one line for each view that could not be read
};

/// Detects the target in every view of a session directory, two or more views at a time, with a
/// line of progress for each. A view that cannot be read is rejected with its reason, and
/// the rest goes on.
SessionDetection DetectSession(const Session& session, const std::string& method,
                               const Progress& progress);

}  // namespace rgbdt
