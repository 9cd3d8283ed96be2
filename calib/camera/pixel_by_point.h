#pragma once

#include <Eigen/Core>

#include "calib/model/rig.h"

namespace rgbdt {

/// Derivative of a point's pixel by the point [px/m], camera axes, through the whole lens; the
/// point must be one that Camera::Project sees.
Eigen::Matrix<double, 2, 3> PixelByPoint(const Lens& lens, const Eigen::Vector3d& point);

}  // namespace rgbdt
