#pragma once

#include <vector>

#include "calib/model/rig.h"
#include "calib/simulate/internal/scanner.h"
#include "calib/simulate/internal/scene.h"
#include "calib/simulate/options.h"

namespace rgbdt::simulate {

class Noise;

/// Where a camera truly sits: its nominal place looking straight ahead (camera z along LIDAR x, x
/// along -y, y along -z), moved and tilted by what seed and name draw.
Rigid3 DrawCameraFromLidar(const CameraOptions& camera, std::uint64_t seed);

/// Where a LIDAR beside the rig's own truly sits: its nominal place, moved, turned and tilted by
/// what seed and name draw. point_in_reference = reference_from_lidar * point_in_lidar.
Rigid3 DrawReferenceFromLidar(const FurtherLidarOptions& lidar, std::uint64_t seed);

/// Of the noise of LIDAR `index` of Options::further_lidars.
std::uint64_t SeedOfLidar(std::uint64_t seed, std::size_t index);

/// What a person would measure: the truth turned by up to `guess_rotation_rad`, with the camera's
/// centre moved by up to `guess_translation_m` (both at least 0.4 times that).
Rigid3 DrawGuess(const Options& options, const std::string& camera,
                 const Rigid3& camera_from_lidar);

/// What the user knows of the rig; `camera_from_lidar` is in the order of options.cameras.
Rig MakeRig(const Options& options, const Scanner& scanner, const SceneModel& scene,
            const std::vector<Rigid3>& camera_from_lidar);

/// An evenly distributed unit vector from the stream's numbers `index` and `index` + 1.
Eigen::Vector3d DrawDirection(const Noise& noise, std::uint64_t index);

}  // namespace rgbdt::simulate
