#pragma once

#include <Eigen/Core>
#include <array>
#include <utility>
#include <vector>

#include "calib/model/rig.h"

namespace rgbdt::study {

/// A board as it is, whatever the rig says of it: as it was printed, and not quite flat. A point of
/// it lies behind its mean plane by a bulge along its width, a twist, and a bulge along its height.
struct TrueBoard {
  Target target;
  Eigen::Vector3d bow_m{0, 0, 0};    ///< along the width, twist, along the height
  std::array<double, 4> beyond_m{};  ///< sides 0 to 3 lie so much farther out than the target's

  TrueBoard() = default;
  TrueBoard(Target flat) : target(std::move(flat)) {}  // NOLINT(google-explicit-constructor)

  /// How far behind the mean plane [m], at a place of the target [m].
  double Behind(const Eigen::Vector2d& place) const {
    const double u = 2 * place.x() / target.width_m;
    const double v = 2 * place.y() / target.height_m;
    return bow_m[0] * (u * u - 1.0 / 3) + bow_m[1] * u * v + bow_m[2] * (v * v - 1.0 / 3);
  }
  /// Where a point of the flat board lies; target frame.
  Eigen::Vector3d Bent(const Eigen::Vector3d& flat) const {
    return flat + Behind(flat.head<2>()) * Eigen::Vector3d::UnitZ();
  }
  std::vector<Eigen::Vector3d> InnerCorners() const {
    std::vector<Eigen::Vector3d> corners = target.InnerCorners();
    for (Eigen::Vector3d& corner : corners) corner = Bent(corner);
    return corners;
  }
};

}  // namespace rgbdt::study
