#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "calib/model/rgbdt_cloud.h"

namespace rgbdt {

/// How alike two places are by what cameras saw there.
struct ColoursAlike {
  double correlation = 0;  ///< of brightness and temperature over space, -1 to 1
  std::size_t cells = 0;   ///< that were seen from both places, by some camera
};

/// What cameras saw of a drive, along its way: brightness and temperature of points. It weighs
/// loops and aligns nothing: two places that look alike to a LIDAR may not to a camera. Memory is
/// bounded: when there are kMostSweeps, every second one is forgotten.
class LoopColours {
 public:
  static constexpr std::size_t kMostSweeps = 2000;
  static constexpr std::size_t kMostPoints = 1500;  ///< of a part, four times so many of a sweep

  /// A part of a whole fused sweep, where the drive's own odometry has it (map_from_lidar); others
  /// are left out.
  void Add(const RgbdtCloud& fused);
  std::size_t size() const { return sweeps_.size(); }

  /// Two places of the way and how a loop has them lie to each other.
  struct Pair {
    Utime old_utime = 0, new_utime = 0;
    Rigid3 world_from_old, world_from_new;  ///< by odometry
    Rigid3 old_from_new;                    ///< by the loop
  };
  /// The correlation of what was seen at both places, in cells of 0.4 m, each against the mean of
  /// its own height: ground and walls differ everywhere alike. Pearson's; of cameras that saw
  /// enough the mean, weighed by their cells.
  ColoursAlike Compare(const Pair& pair) const;

  /// By how much a loop's sigma is enlarged for it: 1 where colours agree or there are too few, up
  /// to 100 where they have nothing in common.
  static double SigmaFactor(const ColoursAlike& alike);

 private:
  struct Point {
    Eigen::Vector3f in_world;
    float brightness, temperature_k;  // NaN: not seen
  };
  struct Sweep {
    Utime sweep_utime = 0, utime = 0;  // which sweep; of the first point
    Eigen::Vector3d at;
    std::vector<Point> points;
  };

  std::vector<Sweep> sweeps_;
  double apart_m_ = 1;  // between sweeps that are kept
};

}  // namespace rgbdt
