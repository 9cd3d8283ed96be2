#pragma once

#include <string>
#include <vector>

#include "calib/files/session/session_dir.h"
#include "calib/methods/progress.h"
#include "calib/model/calibration.h"
#include "calib/model/view_detection.h"

namespace rgbdt {

struct SessionDetection {
  std::vector<ViewDetection> views;     ///< in the session's order; see DetectSession
  std::vector<std::string> unreadable;  ///< one line for each view that could not be read
};

/// Detects the target in every view of a session directory, two or more views at a time, with a
/// line of progress for each, and a warning where ring numbers say nothing. A view that cannot be
/// read is rejected with its reason, and the rest goes on. Of such views `views` has as many as
/// were read, 100 at least, so that what is made of it is bounded by what is there, and still tells
/// where most could not be read.
SessionDetection DetectSession(const Session& session, const std::string& method,
                               const Progress& progress);

/// The session with those of its views alone that `views` has.
Session ListedOnly(Session session, const std::vector<ViewDetection>& views);

/// Each camera's warnings say how many of the session's views `views` does not have.
[[nodiscard]] Report WithUnlisted(Report report, const Session& session,
                                  const std::vector<ViewDetection>& views);

}  // namespace rgbdt
