#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/rig.h"

namespace rgbdt {

// The calibration for other tools. Every file says which way its transforms go. All throw
// InputError: a camera that the rig does not have, nothing calibrated, a frame's name that ROS
// would not take, a file that cannot be written.

/// What frames are to be called in ROS.
struct FrameNames {
  std::string lidar;                           ///< empty: as the rig calls the LIDAR
  std::map<std::string, std::string> cameras;  ///< by camera; not in it: `<camera>_optical_frame`
};

/// YAML for cv::FileStorage: per camera size, camera_matrix, distortion and camera_from_lidar 4x4.
void ExportOpenCv(const std::filesystem::path& path, const Rig& rig,
                  const Calibration& calibration);

/// Kalibr's camchain.yaml. Its radtan lens has four coefficients: where the rig's has more, the
/// file says so and gives them all in a comment.
void ExportKalibr(const std::filesystem::path& path, const Rig& rig,
                  const Calibration& calibration);

/// A function of MATLAB, named as the file is: per camera camera_from_lidar 4x4, as rigidtform3d
/// takes it (points are columns, the matrix in front; metres), and the lens, pixels counted from 1.
void ExportMatlab(const std::filesystem::path& path, const Rig& rig,
                  const Calibration& calibration);

// ROS: the parent is the LIDAR, the child the camera's optical frame. What ROS calls their
// transform is the child's pose in the parent, lidar_from_camera.

/// The static_transform_publisher command lines of ROS 1 and ROS 2.
void ExportRosStaticTransform(const std::filesystem::path& path, const Rig& rig,
                              const Calibration& calibration, const FrameNames& frames = {});

/// A launch file of ROS 2 in YAML: one static_transform_publisher a camera.
void ExportRosLaunch(const std::filesystem::path& path, const Rig& rig,
                     const Calibration& calibration, const FrameNames& frames = {});

/// A URDF: a link for the LIDAR and for each camera, a fixed joint from the one to the other.
/// LIDARs beside the reference are links likewise, and transforms of the other two files, their
/// frames called as the rig calls them.
void ExportUrdf(const std::filesystem::path& path, const Rig& rig, const Calibration& calibration,
                const FrameNames& frames = {});

/// Autoware's sensor_kit_calibration.yaml: under the LIDAR's frame x y z [m] roll pitch yaw [rad]
/// of each camera_link, whose axes are x forward, y left, z up, and of LIDARs beside the reference.
/// It is named as the camera's optical frame is, without "_optical"; unless that is given
/// `<camera>/camera_link`.
void ExportAutoware(const std::filesystem::path& path, const Rig& rig,
                    const Calibration& calibration, const FrameNames& frames = {});

struct ExportedFile {
  std::filesystem::path path;
  std::string purpose;  ///< what it is for, in words
};

/// All of them into `dir`.
std::vector<ExportedFile> ExportAll(const std::filesystem::path& dir, const Rig& rig,
                                    const Calibration& calibration, const FrameNames& frames = {});

}  // namespace rgbdt
