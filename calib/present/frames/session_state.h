#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/observation.h"
#include "calib/model/rig.h"
#include "calib/model/session.h"

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
  std::string waits;                      ///< what is missing; empty: nothing
  std::vector<std::string> picks_wanted;  ///< cameras whose image waits for a person's picks
  std::map<std::string, Utime> images;    ///< by camera: the image that belongs to it
  std::map<std::string, Observation> observations;  ///< by camera
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

/// What a view shows of the board in the cloud: the observation whose candidate the calibration
/// chooses or, without one, the first that has any. Nothing where no camera has one.
std::optional<Observation> ObservedBoard(const std::map<std::string, Observation>& by_camera,
                                         const Calibration& calibration);

/// A RigFrame.
std::string RigFrame(const Rig& rig);

/// A SessionFrame. `rig` may be null: none is known yet.
std::string SessionFrame(const SessionState& state, const Rig* rig);

}  // namespace rgbdt
