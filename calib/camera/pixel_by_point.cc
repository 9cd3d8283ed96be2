#include "calib/camera/pixel_by_point.h"

#include <ceres/jet.h>

#include "calib/camera/lens.h"

namespace rgbdt {

Eigen::Matrix<double, 2, 3> PixelByPoint(const Lens& lens, const Eigen::Vector3d& point) {
  using Jet = ceres::Jet<double, 3>;
  Jet u;
  Jet v;
  ProjectUnchecked(lens, Jet(point.x(), 0), Jet(point.y(), 1), Jet(point.z(), 2), &u, &v);
  Eigen::Matrix<double, 2, 3> out;
  out << u.v.transpose(), v.v.transpose();
  return out;
}

}  // namespace rgbdt
