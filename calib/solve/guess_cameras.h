#pragma once

#include <optional>
#include <vector>

#include "calib/model/comparison.h"
#include "calib/solve/camera_views.h"
#include "calib/solve/evaluate.h"
#include "calib/solve/first_guess.h"
#include "calib/solve/lidar_views.h"
#include "calib/solve/options.h"

namespace rgbdt {

/// One camera of the rig in two sessions, solved together with its lens and the LIDAR's errors in
/// common: how far it moved on its mount.
struct MountChange {
  std::size_t from = 0, to = 0;  ///< indices into CalibratedCameras::cameras
  PoseComparison moved;          ///< by the covariance that the two have together
};

/// What a method makes of the cameras' views: each one's report, and what they say together.
struct CalibratedCameras {
  std::vector<CameraViews> cameras;
  std::vector<LidarReport> lidars{};  ///< beside the reference
  std::vector<MountChange> changes;   ///< of cameras of one name, each against the first of them
  std::vector<Closure> closure;
  std::optional<NextView> next_view;
};

/// A camera and where the first guess puts it. With a pose, its usable views know their board;
/// without one, no method can go on, and its report says why.
struct GuessedCamera {
  CameraViews views;
  FirstGuess guess;
};

/// The first guess of each camera, with which a solve begins.
std::vector<GuessedCamera> GuessCameras(const CalibrateOptions& options,
                                        std::vector<CameraViews> cameras);

/// Their views and reports, once no guess is needed any more.
std::vector<CameraViews> WithoutGuesses(std::vector<GuessedCamera> cameras);

/// A camera's calibration with its degeneracy: a pose that the views leave loose is not to be
/// believed, whatever its residuals: its status says so, and its covariance goes.
CameraCalibration WithDegeneracy(const CameraViews& camera);

/// A camera's report with its calibration judged on used and held-out views.
CameraReport JudgeViews(const EdgeModel& edges, const CameraViews& camera);

}  // namespace rgbdt
