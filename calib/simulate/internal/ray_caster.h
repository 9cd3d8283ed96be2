#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <vector>

#include "calib/simulate/internal/mesh.h"

namespace rgbdt::simulate {

/// First surface on a ray.
struct Hit {
  double range = std::numeric_limits<double>::infinity();  ///< [m]; infinite: nothing
  int object = -1;                                         ///< index of the mesh
  int triangle = -1;                                       ///< of that mesh
  Eigen::Vector3d normal{0, 0, 0};  ///< unit, towards the ray's origin; smooth on round meshes

  bool hit() const { return object >= 0; }
};

/// Embree behind a small face: rays against a list of meshes. May be used by several threads.
class RayCaster {
 public:
  explicit RayCaster(const std::vector<Mesh>& meshes);
  ~RayCaster();
  RayCaster(RayCaster&&) noexcept;
  RayCaster& operator=(RayCaster&&) noexcept;

  /// `direction` is a unit vector.
  Hit Cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;
  /// `count` rays from one point; writes `count` hits. Faster than one by one; normals stay zero.
  void CastFan(const Eigen::Vector3d& origin, const Eigen::Vector3d* directions, int count,
               Hit* hits) const;
  /// Whether anything lies on the ray before `range` [m].
  bool Blocked(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double range) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rgbdt::simulate
