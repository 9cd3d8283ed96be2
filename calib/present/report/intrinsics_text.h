#pragma once

#include <string>

#include "calib/methods/session_corners.h"
#include "calib/model/intrinsics.h"

namespace rgbdt {

/// One camera's intrinsic calibration for a person: every parameter with its sigma and what the rig
/// file said before, every view, which part of the image was covered and what to do about the rest.
std::string IntrinsicsText(const CameraSpec& before, const CameraCorners& corners,
                           const IntrinsicsResult& result);

/// "pinhole5", "pinhole8", "fisheye": as a person types them.
std::string NameOf(LensChoice choice);

}  // namespace rgbdt
