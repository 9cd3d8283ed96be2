#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/rig.h"
#include "calib/model/session.h"
#include "calib/model/view_detection.h"

namespace rgbdt {

/// The uncertainty of the calibration with so many views.
struct SigmaStep {
  int views = 0;
  std::map<std::string, std::pair<double, double>> cameras;  ///< rotation [deg], centre [mm]
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
  std::vector<SigmaStep> sigma;
  Calibration calibration;  ///< each camera's newest
  std::map<std::string, Utime> calibration_utime;
  std::optional<Report> report;  ///< the newest
};

/// 1 sigma of a calibration: rotation, RMS of the three axes [deg], and centre, likewise [mm].
std::optional<std::pair<double, double>> SigmaOf(const CameraCalibration& calibration);

/// Whether a view's detection can be used for this camera: the board was found in its image and in
/// the cloud.
bool IsUsable(const ViewState& view, const std::string& camera);

/// The board in a view's cloud: the candidate that a calibrated camera chooses or, without one, the
/// likeliest. Nothing where there is none.
std::optional<CloudEdges> BoardInCloud(const ViewDetection& detection,
                                       const Calibration& calibration);

/// A RigFrame.
std::string RigFrame(const Rig& rig);

/// A SessionFrame. `rig` may be null: none is known yet.
std::string SessionFrame(const SessionState& state, const Rig* rig);

}  // namespace rgbdt
