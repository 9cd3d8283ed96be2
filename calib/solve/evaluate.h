#pragma once

#include <optional>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/observation.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// How well a calibration lays a view's boundary points on the image. The view must be usable.
/// distance_transform_px: mean of the distance transform at the projected points (the paper's
/// reprojection error). edge_rms_px: RMS distance to the fitted outline. A point that the lens
/// cannot see counts half the image's width.
ViewQuality JudgeView(const CameraSpec& camera, const Observation& observation,
                      const Rigid3& camera_from_lidar);

/// Fills in `views`, `distance_transform_px` and `edge_rms_px` of a camera's report from its
/// calibration: means over all points of the views used, and of those held out.
void JudgeCamera(const CameraSpec& camera, const std::vector<const Observation*>& usable,
                 CameraReport* report);

}  // namespace rgbdt
