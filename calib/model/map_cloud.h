#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "calib/model/time.h"

namespace rgbdt {

/// A map as a cloud: one point a voxel. All vectors are as long as `points`.
struct MapCloud {
  std::string frame = "map";  ///< "map": the pose stream's; "lidar": of a rig that stood still
  double voxel_m = 0;         ///< edge of a voxel; 0: not from voxels, each point is one of a sweep
  std::vector<Eigen::Vector3f> points;           ///< mean of the points seen [m]
  std::vector<std::array<std::uint8_t, 3>> rgb;  ///< mean, red green blue; 0: no camera saw it
  std::vector<float> temperature_k;              ///< mean; NaN: no thermal camera saw it
  std::vector<std::uint32_t> count;              ///< points seen, 1 or more
  std::vector<Utime> last_seen;                  ///< time of the newest; 0: unknown

  std::size_t size() const { return points.size(); }
};

}  // namespace rgbdt
