#pragma once

#include <optional>
#include <vector>

#include "calib/solve/camera_views.h"
#include "calib/solve/evaluate.h"
#include "calib/solve/first_guess.h"
#include "calib/solve/options.h"

namespace rgbdt {

/// What a method makes of the cameras' views: each one's report, and what they say together.
struct CalibratedCameras {
  std::vector<CameraViews> cameras;
  std::vector<Closure> closure;
  std::optional<NextView> next_view;
};

/// A camera and where the first guess puts it; its usable views know their board.
struct GuessedCamera {
  CameraViews* views = nullptr;
  FirstGuess guess;  ///< with a pose
};

/// The first guess of each camera, with which a solve begins. A camera without one is left out; its
/// report says why.
std::vector<GuessedCamera> GuessCameras(const CalibrateOptions& options,
                                        std::vector<CameraViews>* cameras);

/// A camera's calibration with its degeneracy: a pose that the views leave loose is not to be
/// believed, whatever its residuals: its status says so, and its covariance goes.
CameraCalibration WithDegeneracy(const CameraViews& camera);

/// Judges the calibrations in the cameras' reports on used and held-out views.
void JudgeCameras(const EdgeModel& edges, const std::vector<GuessedCamera>& cameras);

/// Adds the solve's computing time to the cameras' reports, in equal parts.
void ShareTime(double seconds, const std::vector<GuessedCamera>& cameras);

}  // namespace rgbdt
