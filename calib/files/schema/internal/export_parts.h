#pragma once

// What exports to other tools share.

#include <string>
#include <vector>

#include "calib/files/schema/exports.h"

namespace rgbdt::exports {

constexpr char kFrames[] =
    "LIDAR frame: x forward, y left, z up. Camera frame: x right, y down, z forward. Metres.";

/// A camera's spec beside its calibration.
struct Exported {
  CameraSpec spec;  ///< with the lens that belongs to the pose
  const CameraCalibration& calibration;
};

/// Throws InputError where a camera is not the rig's, and where there is none.
std::vector<Exported> Match(const Rig& rig, const Calibration& calibration);

/// Numbers that read back as the same bits, spaces between them.
std::string List(const double* values, int count);

/// What a reader must know of a camera that did not converge, in one line; empty: it did.
std::string StatusWarning(const Exported& camera);

/// `text` as comment lines that begin with "# ".
std::string HashComment(const std::string& text);

}  // namespace rgbdt::exports
