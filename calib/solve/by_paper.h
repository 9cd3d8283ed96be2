#pragma once

#include "calib/solve/calibrate.h"
#include "calib/solve/camera_views.h"

namespace rgbdt {

/// One camera from its hand-measured guess, by the paper's solve; with wide_start a second time
/// from a start turned away. Without enough views its pose is the guess, and the status says so.
void CalibrateByPaper(const CalibrateOptions& options, CameraViews* camera);

}  // namespace rgbdt
