#pragma once

#include <vector>

#include "calib/solve/camera_views.h"
#include "calib/solve/guess_cameras.h"
#include "calib/solve/options.h"

namespace rgbdt {

/// "auto": see Calibrate. Cameras of one name are one, in several sessions: each has a pose of its
/// own, and all one lens. Their views have different names.
CalibratedCameras CalibrateByBoards(const Target& target, const CalibrateOptions& options,
                                    std::vector<CameraViews> cameras);

}  // namespace rgbdt
