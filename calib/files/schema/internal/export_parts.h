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

/// A list in brackets for YAML. By YAML 1.1, which Python reads, "1e-05" is a word and "1.0e-05" a
/// number.
std::string YamlList(const double* values, int count);
std::string YamlNumber(double value);

/// The pose as 4x4.
Eigen::Matrix4d MatrixOf(const Rigid3& pose);

/// Whether a pinhole's coefficients from this one on are used: not every tool has the higher ones.
bool HasTerms(const Lens& lens, std::size_t from);

/// What a reader must know of a camera that did not converge, in one line; empty: it did.
std::string StatusWarning(const Exported& camera);

/// `text` as comment lines that begin with "# ".
std::string HashComment(const std::string& text);

}  // namespace rgbdt::exports
