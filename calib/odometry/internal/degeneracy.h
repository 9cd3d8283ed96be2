#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "calib/model/rigid3.h"
#include "calib/odometry/internal/plane_map.h"

namespace rgbdt::odometry {

/// A point matched to a plane: what it tells of a small motion of the LIDAR.
struct Evidence {
  Eigen::Vector3d in_middle;  ///< [m]
  double weight = 0;          ///< [1/m^2]
  Vector6d slope;             ///< of the distance
  Match match;
  Eigen::Quaterniond middle_from_world;
};

/// Of a small motion with turns times a lever: orthonormal columns, six together.
struct Directions {
  Eigen::Matrix<double, 6, Eigen::Dynamic> told = Matrix6d::Identity(), degenerate{6, 0};
};

/// What a sweep tells of the LIDAR's place, without what planes' noise seems to tell: the normals
/// of a corridor's walls are tilted by chance, each other way, and squared that looks as if the
/// walls told the way along them. Their expected share is taken out, and thrice its scatter; and
/// the few voxels that tell most of a direction: what hangs on them alone, as on a voxel in which
/// two walls that meet were taken for one plane, is not told.
class Information {
 public:
  void Add(const Evidence& evidence);

  /// Degenerate are those in which less is told than a displacement of `limit_m` (1 sigma).
  Directions Told(double lever_m, double limit_m) const;

 private:
  struct Sums {
    Matrix6d all = Matrix6d::Zero(), noise = Matrix6d::Zero();
  };
  double LeastTold(const Vector6d& delta) const;

  std::map<std::pair<int, std::uint32_t>, Sums> voxels_;  // by level and number
};

/// Each direction in words: "a move along the LIDAR's x (forward)".
std::vector<std::string> DegenerateWords(
    const Eigen::Matrix<double, 6, Eigen::Dynamic>& directions);

}  // namespace rgbdt::odometry
