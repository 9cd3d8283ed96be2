#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "calib/model/cloud.h"

namespace rgbdt {

/// Points that returned, as the fuser keeps them: nothing is known of their colour yet. All vectors
/// are equally long.
struct Hits {
  std::vector<Eigen::Vector3f> points;  ///< [m]
  std::vector<float> intensity;         ///< 0 to 1; NaN: unknown
  std::vector<Utime> utime;

  std::size_t size() const { return points.size(); }
  bool empty() const { return points.empty(); }
  void Append(const Hits& more);
  /// Points [first, end).
  Hits Part(std::size_t first, std::size_t end) const;
  void Clear();
};

/// The chunk's points that returned, with intensities (NaN where the chunk has none) and times
/// (where it has none, its sweep's).
Hits HitsOf(const Cloud& chunk);

}  // namespace rgbdt
