#pragma once

#include <string>
#include <vector>

#include "calib/methods/calibrate.h"
#include "calib/model/comparison.h"

namespace rgbdt {

/// What detection found in one of several sessions of a rig.
struct SessionViews {
  std::string name;
  std::vector<ViewDetection> detections;  ///< views of one name only once, whatever the session
};

/// Several sessions of a rig, whose lenses and LIDAR's errors are the same ones.
struct CalibratedSessions {
  /// By session, each with the cameras' poses in it. No closure and no next view.
  std::vector<Report> reports;
  /// Two sessions each: where a camera was first solved, and a later one.
  std::vector<CalibrationComparison> comparisons;
};

/// Solves sessions together, in each of which a camera has a pose of its own ("auto" only): the
/// lens, what the LIDAR is off by, the board and its edges are known by all views. How far cameras
/// moved from session to session is known better than by two calibrations that were made apart,
/// since what these have in common cancels.
CalibratedSessions CalibrateSessions(const Rig& rig, const std::vector<SessionViews>& sessions,
                                     const CalibrateOptions& options = {});

/// A report of all sessions as one, in which each camera that moved in between has a contradiction:
/// beyond what chance does in one of a hundred sets of sessions.
[[nodiscard]] Report WithChanges(Report report,
                                 const std::vector<CalibrationComparison>& comparisons);

}  // namespace rgbdt
