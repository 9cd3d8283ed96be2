#pragma once

#include "calib/solve/camera_views.h"
#include "calib/solve/options.h"

namespace rgbdt {

/// One camera from its hand-measured guess, by the paper's solve; with wide_start a second time
/// from a start turned away. Without enough views its pose is the guess, and the status says so.
CameraReport CalibrateByPaper(const CalibrateOptions& options, const CameraViews& views);

/// Levenberg-Marquardt over the paper's objective from one start: the rotation first, then all six
/// parameters. `used` are usable views of one camera.
CameraCalibration SolvePaper(const CameraSpec& spec, const std::vector<const CameraView*>& used,
                             const Rigid3& start, const CalibrateOptions& options);

/// The guess turned by roll about the LIDAR's x, then yaw about its z.
Rigid3 TurnedStart(const Rigid3& camera_from_lidar, double roll_rad, double yaw_rad);

}  // namespace rgbdt
