#pragma once

#include <vector>

#include "calib/solve/camera_views.h"
#include "calib/solve/guess_cameras.h"
#include "calib/solve/lidar_views.h"
#include "calib/solve/options.h"

namespace rgbdt {

/// "auto": see Calibrate. Cameras of one name are one, in several sessions: each has a pose of its
/// own, and all one lens. Their views have different names.
CalibratedCameras CalibrateByBoards(const Target& target, const CalibrateOptions& options,
                                    std::vector<CameraViews> cameras);

/// The same of a rig with more LIDARs than the one whose frame is the rig's: their poses are in the
/// same problem, by the boards of the cameras' views. Where cameras are solved apart
/// (CalibrateOptions::joint), LIDARs are solved with the first of them.
CalibratedCameras CalibrateWithLidars(const Target& target, const CalibrateOptions& options,
                                      std::vector<CameraViews> cameras,
                                      std::vector<LidarViews> lidars);

}  // namespace rgbdt
