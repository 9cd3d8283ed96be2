#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

namespace rgbdt {

/// Points near a point, by PCL's k-d tree. PCL stays behind this header.
class PointIndex {
 public:
  explicit PointIndex(const std::vector<Eigen::Vector3f>& points);
  ~PointIndex();
  /// Indices within `radius` [m], nearest first.
  void Within(const Eigen::Vector3f& centre, double radius, std::vector<int>* indices) const;
  /// The `count` nearest, nearest first.
  void Nearest(const Eigen::Vector3f& centre, int count, std::vector<int>* indices) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Steps c and d of the paper with PCL's own implementations: Moving Least Squares, boundary
/// estimation, concave hull. Lengths in metres. Returns the boundary points.
struct BoundaryOptions {
  double mls_radius = 0;
  double boundary_radius = 0;
  double boundary_angle_rad = 0;
  double hull_alpha = 0;
};
std::vector<Eigen::Vector3f> BoundaryByPcl(const std::vector<Eigen::Vector3f>& segment,
                                           const BoundaryOptions& options);

}  // namespace rgbdt
