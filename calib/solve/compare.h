#pragma once

#include <optional>

#include "calib/model/comparison.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// With delta = Log(b * a^-1), camera axes (rigid3.h), and C_b + Ad(b a^-1) C_a Ad^T its covariance
/// where the two are independent. `spec`: null where the lens is not known. `b_with_a`, of two that
/// come of one solve and have the lens in common: the covariance of b's delta with a's.
PoseComparison Compare(const CameraCalibration& a, const CameraCalibration& b,
                       const CameraSpec* spec,
                       const std::optional<Matrix6d>& b_with_a = std::nullopt);

}  // namespace rgbdt
