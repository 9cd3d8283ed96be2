#pragma once

#include <Eigen/Core>

#include "calib/model/rigid3.h"

namespace rgbdt::python {

/// The 4x4 matrix of a_from_b: (point_in_a, 1) = matrix * (point_in_b, 1).
inline Eigen::Matrix4d MatrixOf(const Rigid3& motion) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = motion.rotation.toRotationMatrix();
  matrix.topRightCorner<3, 1>() = motion.translation;
  return matrix;
}

}  // namespace rgbdt::python
