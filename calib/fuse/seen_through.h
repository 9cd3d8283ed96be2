#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace rgbdt {

/// How far a sweep has looked in each direction so far: tells of a thing that the sweep before saw
/// whether it is gone. Directions from the LIDAR frame's origin, in cells of half a degree on the
/// faces of a cube.
class SeenThrough {
 public:
  explicit SeenThrough(double range_sigma_m);

  /// Points [m] from `first` on.
  void Add(const std::vector<Eigen::Vector3f>& points, std::size_t first = 0);
  void Clear();

  /// Whether all that was seen in a place's direction and round it lies clearly behind it. Not
  /// where something round it was not looked at yet.
  bool IsGone(const Eigen::Vector3f& place) const;

 private:
  std::vector<float> nearest_m_;  // by face, row and column; 0: nothing seen
  float margin_m_;
};

}  // namespace rgbdt
