#pragma once

#include <string>

#include "calib/model/intrinsics.h"

namespace rgbdt {

/// One camera's intrinsic calibration, as IntrinsicsText and IntrinsicsHtml show it.
struct CameraIntrinsics {
  CameraSpec before;  ///< as the rig file has it
  CameraCorners corners;
  IntrinsicsResult result;
};

/// For a terminal: every parameter with its sigma and what the rig file said before, every view,
/// which part of the image was covered and what to do about the rest.
std::string IntrinsicsText(const CameraIntrinsics& camera);

/// One line: which lens model the images want instead, and how to ask for it; or that none fits
/// better.
std::string LensComparisonText(const LensComparison& comparison);

/// "pinhole5", "pinhole8", "fisheye": as a person types them.
std::string NameOf(LensChoice choice);

}  // namespace rgbdt
