#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "calib/model/time.h"

namespace rgbdt {

/// The fused cloud: points that returned (misses are left out), LIDAR frame [m].
/// All vectors are as long as `points`.
struct RgbdtCloud {
  std::int64_t seq = 0;
  Utime sweep_utime = 0;
  Utime calibration_utime = 0;  ///< of the calibration used; 0: none yet, nothing coloured
  bool sweep_end = false;
  std::vector<std::string> cameras;  ///< bit i of `valid` stands for cameras[i]; 32 at most
  std::vector<Eigen::Vector3f> points;
  std::vector<float> intensity;  ///< 0 to 1
  std::vector<Utime> utime;
  std::vector<std::array<std::uint8_t, 3>> rgb;  ///< 1 to 255; 0 where no colour camera saw it
  std::vector<float> temperature_k;              ///< NaN where no thermal camera saw it
  std::vector<float> thermal_counts;             ///< raw counts; NaN likewise
  std::vector<std::uint32_t> valid;              ///< which cameras saw it

  std::size_t size() const { return points.size(); }
};

}  // namespace rgbdt
