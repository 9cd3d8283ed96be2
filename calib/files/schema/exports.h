#pragma once

#include <filesystem>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/rig.h"

namespace rgbdt {

// The calibration for other tools. Every file says which way its transforms go. All throw
// InputError: a camera that the rig does not have, nothing calibrated, a file that cannot be
// written.

/// YAML for cv::FileStorage: per camera size, camera_matrix, distortion and camera_from_lidar 4x4.
void ExportOpenCv(const std::filesystem::path& path, const Rig& rig,
                  const Calibration& calibration);

/// The static_transform_publisher command lines of ROS 1 and ROS 2: parent the LIDAR, child
/// `<camera>_optical_frame`, so the pose of the camera in the LIDAR frame (lidar_from_camera).
void ExportRosStaticTransform(const std::filesystem::path& path, const Rig& rig,
                              const Calibration& calibration);

/// Kalibr's camchain.yaml. Its radtan lens has four coefficients: where the rig's has more, the
/// file says so and gives them all in a comment.
void ExportKalibr(const std::filesystem::path& path, const Rig& rig,
                  const Calibration& calibration);

/// All of them into `dir`; the files written.
std::vector<std::filesystem::path> ExportAll(const std::filesystem::path& dir, const Rig& rig,
                                             const Calibration& calibration);

}  // namespace rgbdt
