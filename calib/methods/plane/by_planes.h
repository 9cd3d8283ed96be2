#pragma once

#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"
#include "calib/solve/camera_views.h"
#include "calib/solve/guess_cameras.h"
#include "calib/solve/options.h"

namespace rgbdt {

/// Point-to-plane over board views (Unnikrishnan and Hebert, Fast Extrinsic Calibration of a Laser
/// Rangefinder to a Camera, 2005): the sum over all points on all boards of their squared distances
/// from the plane in which the camera sees the board, least squares over camera_from_lidar from a
/// start nearby. Every point counts the same, where it was measured; the planes count as exact;
/// edges have no say. The covariance is the usual one, by the residuals. `used`: usable views of
/// one camera with image poses and scatters.
CameraCalibration SolvePlanes(const std::vector<const CameraView*>& used, const Rigid3& start);

/// "plane": see Calibrate.
CalibratedCameras CalibrateByPlanes(const Target& target, const CalibrateOptions& options,
                                    std::vector<CameraViews> cameras);

}  // namespace rgbdt
