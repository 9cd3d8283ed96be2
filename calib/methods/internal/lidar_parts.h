#pragma once

// LIDARs beside the rig's reference: who is not calibrated, and one that was, on other views.

#include <string>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/view_detection.h"
#include "calib/solve/camera_views.h"
#include "calib/solve/lidar_views.h"

namespace rgbdt {

/// Said with the cameras, as there is no result to say it with.
void SayNotCalibrated(const std::string& lidar, const std::string& why,
                      std::vector<CameraViews>* cameras);

/// Those of whom there is any cloud; of the others it is said that there is none.
[[nodiscard]] std::vector<LidarViews> WithClouds(std::vector<LidarViews> lidars,
                                                 std::vector<CameraViews>* cameras);

/// A pose that was found elsewhere, by these views: how far the board's middle in its clouds lies
/// from where the reference's clouds have it, the median of the views. Beyond 0.1 m the pose is not
/// to be used.
LidarReport JudgedLidar(const LidarCalibration& lidar,
                        const std::vector<ViewDetection>& detections);

}  // namespace rgbdt
