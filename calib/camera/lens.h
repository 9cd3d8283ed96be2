#pragma once

#include <cmath>

#include "calib/model/rig.h"

namespace rgbdt {

/// Stateless lens models: a direction (x/z, y/z and, for the fisheye, z's sign) to distorted,
/// normalised image coordinates. Templated on the scalar, so that double and ceres::Jet run the
/// same text. `k` is Lens::distortion. Formulas and coefficients are OpenCV's.
struct PinholeLens {
  /// The radial part at r2 = x^2 + y^2: (1 + k1 r2 + k2 r4 + k3 r6) / (1 + k4 r2 + k5 r4 + k6 r6).
  template <typename T, typename K>
  static T Radial(const K* k, const T& r2) {
    return (T(1) + r2 * (T(k[0]) + r2 * (T(k[1]) + r2 * T(k[4])))) /
           (T(1) + r2 * (T(k[5]) + r2 * (T(k[6]) + r2 * T(k[7]))));
  }

  template <typename T, typename K>
  static void Distort(const K* k, const T& x, const T& y, T* xd, T* yd) {
    const T r2 = x * x + y * y;
    const T radial = Radial(k, r2);
    const T xy2 = T(2) * x * y;
    *xd = x * radial + T(k[2]) * xy2 + T(k[3]) * (r2 + T(2) * x * x);
    *yd = y * radial + T(k[2]) * (r2 + T(2) * y * y) + T(k[3]) * xy2;
  }
};

/// Equidistant fisheye (Kannala and Brandt 2006): the distorted radius is
/// theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8), theta the angle off the axis.
struct FisheyeLens {
  template <typename T, typename K>
  static T Radius(const K* k, const T& theta) {
    const T t2 = theta * theta;
    return theta * (T(1) + t2 * (T(k[0]) + t2 * (T(k[1]) + t2 * (T(k[2]) + t2 * T(k[3])))));
  }

  template <typename T, typename K>
  static void Distort(const K* k, const T& px, const T& py, const T& pz, T* xd, T* yd) {
    using std::atan2;
    using std::sqrt;
    const T r2 = px * px + py * py;
    if (!(r2 > T(1e-24))) {  // on the axis: theta / r tends to 1 / z
      *xd = px / pz;
      *yd = py / pz;
      return;
    }
    const T r = sqrt(r2);
    const T scale = Radius(k, atan2(r, pz)) / r;
    *xd = px * scale;
    *yd = py * scale;
  }
};

/// Projects a point in camera axes (x right, y down, z forward; z > 0) to a pixel, without any
/// check: see Camera::Project for those. The lens's numbers have a scalar K of their own, so that
/// they can be what is solved for: `f` is fx fy, `c` is cx cy [px], `k` is Lens::distortion, all 8.
template <typename T, typename K>
void ProjectUnchecked(Lens::Model model, const K* f, const K* c, const K* k, const T& px,
                      const T& py, const T& pz, T* u, T* v) {
  T xd;
  T yd;
  if (model == Lens::Model::kFisheye) {
    FisheyeLens::Distort(k, px, py, pz, &xd, &yd);
  } else {
    PinholeLens::Distort(k, T(px / pz), T(py / pz), &xd, &yd);
  }
  *u = T(f[0]) * xd + T(c[0]);
  *v = T(f[1]) * yd + T(c[1]);
}

/// The same for a lens that is known.
template <typename T>
void ProjectUnchecked(const Lens& lens, const T& px, const T& py, const T& pz, T* u, T* v) {
  const double f[2] = {lens.fx, lens.fy};
  const double c[2] = {lens.cx, lens.cy};
  ProjectUnchecked(lens.model, f, c, lens.distortion.data(), px, py, pz, u, v);
}

}  // namespace rgbdt
