#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/rigid3.h"
#include "calib/model/time.h"

namespace rgbdt {

/// The fused cloud: points that returned (misses are left out), LIDAR frame [m].
/// All vectors are as long as `points` but for those of the cameras.
struct RgbdtCloud {
  std::int64_t seq = 0;
  Utime sweep_utime = 0;
  bool sweep_end = false;
  /// False: a chunk, as soon as it could be coloured. True: part of a whole sweep, its points
  /// tested for occlusion by all others, those after them, too.
  bool whole_sweep = false;
  std::vector<std::string> cameras;  ///< bit i of `valid` stands for cameras[i]; 32 at most
  /// Of each camera's calibration; 0: none yet, it coloured nothing.
  std::vector<Utime> calibration_utime;
  /// Where the rig was at frame_utime, if a pose stream says so: then all points are in the LIDAR
  /// frame of that time, the rig's motion taken out. Otherwise each is in that of its own time.
  std::optional<Rigid3> map_from_lidar;
  Utime frame_utime = 0;
  std::vector<Eigen::Vector3f> points;
  std::vector<float> intensity;  ///< 0 to 1
  std::vector<Utime> utime;
  std::vector<std::array<std::uint8_t, 3>> rgb;  ///< 1 to 255; 0 where no colour camera saw it
  std::vector<float> temperature_k;              ///< NaN where no thermal camera saw it
  std::vector<float> temperature_sigma_k;        ///< of temperature_k; NaN: unknown
  std::vector<float> thermal_counts;             ///< raw counts; NaN where no thermal camera saw it
  std::vector<std::uint32_t> valid;              ///< which cameras saw it

  std::size_t size() const { return points.size(); }
};

/// The cloud in parts of `most` points at most, in their order; the last keeps `sweep_end`. A cloud
/// without points is one part.
std::vector<RgbdtCloud> PartsOf(RgbdtCloud cloud, std::size_t most);

}  // namespace rgbdt
