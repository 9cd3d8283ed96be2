#pragma once

#include <string>

#include "calib/model/rig.h"

namespace rgbdt {

/// What a result says of the rig file's hand-measured guess: that it lies farther off than anybody
/// measures, and whether it is the other direction, lidar_from_camera. In words; empty: it is near,
/// or there is none.
std::string WhyGuessIsOff(const CameraSpec& camera, const Rigid3& camera_from_lidar);

}  // namespace rgbdt
