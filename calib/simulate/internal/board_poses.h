#pragma once

#include <vector>

#include "calib/simulate/internal/camera_renderer.h"
#include "calib/simulate/internal/scanner.h"
#include "calib/simulate/internal/world.h"

namespace rgbdt::simulate {

/// Where the board stands in view `index`, as a function of (seed, index) and the scene: range,
/// direction, tilt and turn are spread evenly over what PoseOptions allow by a low-discrepancy
/// sequence. Where the board would not be wholly seen by all sensors, it is moved towards the
/// middle of the field, step by step (where a share is to lie outside the image: drawn afresh until
/// it does). Throws InputError where no pose is found.
Rigid3 BoardPose(const Options& options, const World& empty, const Scanner& scanner,
                 const std::vector<CameraRenderer>& cameras, int index);

/// Why a pose does not do; empty: it does. What PoseOptions say of field, margins, clearance and
/// of nothing standing in between.
std::string WhyNotSeen(const Options& options, const World& empty, const Scanner& scanner,
                       const std::vector<CameraRenderer>& cameras, const Rigid3& lidar_from_target);

}  // namespace rgbdt::simulate
