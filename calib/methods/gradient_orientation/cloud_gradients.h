#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "calib/model/cloud.h"

namespace rgbdt {

/// What of a cloud changes from point to point.
enum class CloudFeature {
  kIntensity,  ///< 0 to 1
  kRange,      ///< its logarithm: a metre counts for less far away
};

/// How a cloud's feature changes about one of its points, on the sphere about the sensor.
struct CloudGradient {
  std::size_t point = 0;      ///< index in the cloud
  Eigen::Vector3f direction;  ///< unit, LIDAR frame, across the beam: where the feature grows most
  float strength = 0;         ///< how fast [feature per rad]
};

/// Of all points that have neighbours which tell it: 3 or more of the 8 about it in the grid, not
/// all in one row. Feature kIntensity needs a cloud with intensities.
std::vector<CloudGradient> GradientsOf(const Cloud& cloud, CloudFeature feature);

}  // namespace rgbdt
