#include "calib/camera/pixel_by_point.h"

#include <ceres/jet.h>

#include <array>

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

PixelDerivatives PixelByPointAndLens(const Lens& lens, const Eigen::Vector3d& point) {
  using Jet = ceres::Jet<double, 3 + kLensNumbers>;
  const LensNumbers numbers = NumbersOf(lens);
  std::array<Jet, 4 + std::tuple_size_v<decltype(lens.distortion)>> all;
  for (int i = 0; i < kLensNumbers; ++i) all[static_cast<std::size_t>(i)] = Jet(numbers[i], 3 + i);
  for (std::size_t i = kLensNumbers; i < all.size(); ++i) all[i] = Jet(lens.distortion[i - 4]);
  Jet u;
  Jet v;
  ProjectUnchecked(lens.model, all.data(), &all[2], &all[4], Jet(point.x(), 0), Jet(point.y(), 1),
                   Jet(point.z(), 2), &u, &v);
  PixelDerivatives out;
  out << u.v.transpose(), v.v.transpose();
  return out;
}

}  // namespace rgbdt
