#pragma once

#include <string>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"
#include "calib/solve/camera_views.h"
#include "calib/solve/options.h"

namespace rgbdt {

/// A report without cameras yet: what was detected, with which rig.
Report BlankReport(const Rig& rig, const std::string& method,
                   const std::vector<ViewDetection>& detections);

/// Each camera's views of those detections, in the rig's order.
std::vector<CameraViews> ViewsOfCameras(const Rig& rig,
                                        const std::vector<ViewDetection>& detections);

/// A camera's report, its views described; the report's time becomes that of its newest image.
void AddCamera(CameraViews camera, Report* report);

/// With what the rig says of the LIDAR's ranges, unless the options say it themselves.
CalibrateOptions WithRig(CalibrateOptions options, const Rig& rig);

}  // namespace rgbdt
