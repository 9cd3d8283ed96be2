#pragma once

#include <random>

#include "calib/model/rigid3.h"

namespace rgbdt::study {

/// A direction, evenly over the sphere; the same on every machine.
inline Eigen::Vector3d Direction(std::mt19937_64* random) {
  const auto even = [&] { return static_cast<double>((*random)() >> 11) * 0x1p-52 - 1; };
  for (;;) {
    const Eigen::Vector3d v(even(), even(), even());
    if (v.norm() > 0.1 && v.norm() <= 1) return v.normalized();
  }
}

/// A camera_from_lidar that is turned and moved off the truth by so much.
inline Rigid3 OffBy(const Rigid3& truth, double rotation_rad, double translation_m,
                    std::mt19937_64* random) {
  Vector6d delta;
  delta << rotation_rad * Direction(random), translation_m * Direction(random);
  return Exp(delta) * truth;
}

}  // namespace rgbdt::study
