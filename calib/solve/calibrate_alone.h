#pragma once

#include <functional>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/rig.h"
#include "calib/solve/camera_views.h"
#include "calib/solve/guess_cameras.h"
#include "calib/solve/options.h"

namespace rgbdt {

/// A method that calibrates a camera by its own views, which know their board: their pose from a
/// first guess. May reject views.
using SolveAlone = std::function<CameraCalibration(CameraViews* views, const Rigid3& guess)>;

/// Each camera that has a first guess, solved by itself and judged; with closure if diagnostics are
/// wanted.
CalibratedCameras CalibrateAlone(const Target& target, const CalibrateOptions& options,
                                 std::vector<CameraViews> cameras, const SolveAlone& solve);

}  // namespace rgbdt
