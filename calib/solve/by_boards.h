#pragma once

#include <vector>

#include "calib/solve/camera_views.h"
#include "calib/solve/guess_cameras.h"
#include "calib/solve/options.h"

namespace rgbdt {

/// "auto": see Calibrate.
CalibratedCameras CalibrateByBoards(const Target& target, const CalibrateOptions& options,
                                    std::vector<CameraViews> cameras);

}  // namespace rgbdt
