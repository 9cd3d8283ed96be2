#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/pose_sigma.h"
#include "calib/model/rig.h"
#include "calib/model/session.h"
#include "calib/model/view_detection.h"
#include "calib/solve/colouring.h"

namespace rgbdt {

/// The uncertainty of the calibration with so many views.
struct SigmaStep {
  int views = 0;
  std::map<std::string, PoseError> cameras;  ///< 1 sigma, calib/model/pose_sigma.h
};

/// Views that a person left out of the solve, and what that did.
struct LeftOut {
  std::set<std::string> views;
  /// By camera: from the result with all views to the one without these. Empty: nothing is left
  /// out, or it is not known yet.
  std::map<std::string, PoseChange> moved;
  std::string why_not;  ///< why no view can be left out, and what to do; empty: it can
};

/// A view as the page shows it.
struct ViewState {
  std::string name;
  bool heldout = false;
  std::string waits;                       ///< what is missing; empty: nothing
  std::vector<std::string> picks_wanted;   ///< cameras whose image waits for a person's picks
  std::map<std::string, Utime> images;     ///< by camera: the image that belongs to it
  std::optional<ViewDetection> detection;  ///< nothing: not looked at yet
};

/// All that the Session panel shows, of a live session or a finished one; becomes a SessionFrame.
struct SessionState {
  std::string mode = "none";
  std::vector<std::string> can;
  std::string busy;
  double fraction = 0;
  int step = 0, steps = 0;
  std::string failure;
  std::vector<SessionEvent> log;  ///< newest last
  std::vector<ViewState> views;
  LeftOut left_out;
  std::vector<SigmaStep> sigma;
  Calibration calibration;  ///< each camera's newest
  std::map<std::string, Utime> calibration_utime;
  std::map<std::string, std::vector<ColouringVariance>> projection;  ///< by camera: ProjectionOf
  std::optional<Report> report;                                      ///< the newest
};

/// Whether a view's detection can be used for this camera: the board was found in its image and in
/// the cloud.
bool IsUsable(const ViewState& view, const std::string& camera);

/// The board in a view's cloud: the candidate that a calibrated camera chooses or, without one, the
/// likeliest. Nothing where there is none.
std::optional<CloudEdges> BoardInCloud(const ViewDetection& detection,
                                       const Calibration& calibration);

/// How uncertain it is where points are projected, at any distance; empty: not known.
std::vector<ColouringVariance> ProjectionOf(const Rig& rig, const CameraCalibration& calibration);

/// A RigFrame.
std::string RigFrame(const Rig& rig);

/// A SessionFrame. `rig` may be null: none is known yet.
std::string SessionFrame(const SessionState& state, const Rig* rig);

}  // namespace rgbdt
