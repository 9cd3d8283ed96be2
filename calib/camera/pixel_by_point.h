#pragma once

#include <Eigen/Core>

#include "calib/model/lens.h"

namespace rgbdt {

/// Derivative of a point's pixel by the point [px/m], camera axes, through the whole lens; the
/// point must be one that Camera::Project sees.
Eigen::Matrix<double, 2, 3> PixelByPoint(const Lens& lens, const Eigen::Vector3d& point);

/// The same by the point (first three columns) and by the lens's numbers (NumbersOf).
using PixelDerivatives = Eigen::Matrix<double, 2, 3 + kLensNumbers>;
PixelDerivatives PixelByPointAndLens(const Lens& lens, const Eigen::Vector3d& point);

}  // namespace rgbdt
