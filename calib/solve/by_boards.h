#pragma once

#include <vector>

#include "calib/solve/camera_views.h"
#include "calib/solve/options.h"

namespace rgbdt {

/// "auto": see Calibrate. Fills in the cameras' reports and, of `report`, what concerns
/// several cameras: closure and the next view.
void CalibrateByBoards(const Target& target, const CalibrateOptions& options,
                       std::vector<CameraViews>* cameras, Report* report);

}  // namespace rgbdt
