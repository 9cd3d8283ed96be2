#pragma once

// Where a picture of a cloud is taken from.

#include <Eigen/Core>
#include <vector>

#include "calib/present/pictures/cloud_picture.h"

namespace rgbdt {

/// A pinhole camera. Pixels are those of the picture while it is drawn: kSupersampling times as
/// many as asked for, each way.
struct Viewpoint {
  Eigen::Matrix3d view_from_lidar;  ///< rotation: x right, y down, z into the picture
  Eigen::Vector3d eye;              ///< LIDAR frame [m]
  double focal = 0;                 ///< [px]
  double cx = 0, cy = 0;            ///< [px]

  /// A point of the LIDAR frame in the picture's axes [m].
  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const {
    return view_from_lidar * (point - eye);
  }
};

/// Drawn so many times larger and averaged: smooth edges.
inline constexpr int kSupersampling = 2;

/// As the options say; where they do not: somewhat behind the LIDAR, above it and to its left, and
/// so near that nearly all that a camera saw (or all, where hardly anything was seen) fills the
/// picture. The same for each colour, so that pictures can be laid side by side.
Viewpoint ChooseViewpoint(const RgbdtCloud& cloud, const DrawOptions& options);

}  // namespace rgbdt
