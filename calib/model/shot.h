#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "calib/model/cloud.h"
#include "calib/model/image.h"
#include "calib/model/rigid3.h"

namespace rgbdt {

/// Where the LIDAR was, in axes that all shots of the same world have in common. How worlds lie to
/// each other is not known. By default the rig stood for all shots.
struct ShotPlace {
  int world = 0;
  Rigid3 world_from_lidar;
};

/// A sweep and one camera's image of the same moment: what methods without a target are made from.
/// The rig stood still meanwhile, or motion was taken out. Both outlive the shot.
struct Shot {
  std::string view;  ///< for messages
  const Cloud* cloud = nullptr;
  const Image* image = nullptr;
  ShotPlace place{};
};

/// Parts of an image by which it is said where something was seen: so many columns and rows.
inline constexpr int kPartColumns = 4, kPartRows = 3;
inline constexpr std::size_t kImageParts = std::size_t{kPartColumns} * kPartRows;

/// A pose that was found without a target.
struct SceneFit {
  Rigid3 camera_from_lidar;
  std::optional<Matrix6d> covariance;  ///< of delta (rigid3.h), camera axes; absent: not estimated
  bool converged = false;
  std::string why_not;  ///< where it did not converge: why, and what to do
};

}  // namespace rgbdt
