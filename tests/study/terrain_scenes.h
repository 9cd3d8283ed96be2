#pragma once

// Synthetic ground with its truth: sweeps by the simulated LIDARs, what a vehicle may cross by rays
// straight into the meshes. Nothing here is shared with calib/terrain but its options and result.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "calib/model/map_cloud.h"
#include "calib/simulate/internal/world.h"
#include "calib/simulate/options.h"
#include "calib/terrain/terrain.h"

namespace rgbdt::study {

/// kOutdoor to kNight: the simulator's scenes, with clutter. kCourse: a ramp of 6 to 12 degrees, a
/// kerb of 0.15 m, boxes of 0.15 to 1 m, posts, a table 0.5 m high, a beam 3 m above the ground.
enum class TerrainScene { kOutdoor, kIndoor, kNight, kCourse };

struct TerrainCase {
  TerrainScene scene = TerrainScene::kCourse;
  std::uint64_t seed = 1;       ///< of places, sizes and noise
  double range_sigma_m = 0.01;  ///< noise of a range
  int rings = 0;                ///< 0: the turned scanner; else a spinning LIDAR (SpinningLidar)
};

std::string NameOf(const TerrainCase& which);

/// A world and what one sweep of it gives. The frame is the LIDAR's, moved aside by up to 0.5 m, or
/// every wall of the simulator's rooms would lie on the rim of a cell.
class TerrainWorld {
 public:
  explicit TerrainWorld(const TerrainCase& which);

  const MapCloud& cloud() const { return cloud_; }

  /// Whether a square round a place [m] is ground that a vehicle crosses. An obstacle: any surface
  /// or solid in the square from max_step_m to `top_m` above the ground; a step of the ground
  /// higher than max_step_m, or ground steeper than max_slope_rad. By rays 1/8 of the square apart.
  enum class Truth { kNoGround, kClear, kObstacle };
  Truth At(const Eigen::Vector2d& place, double edge_m, double top_m,
           const TerrainOptions& options) const;

 private:
  struct Column;  // what a vertical ray meets
  Column Look(double x, double y) const;
  bool Crosses(const Eigen::Vector2d& middle, double edge_m, double low_m, double high_m) const;

  std::unique_ptr<simulate::World> world_;
  std::vector<bool> is_ground_;  // by object
  Eigen::Vector2d shift_{0, 0};  // of the cloud against the world
  MapCloud cloud_;
};

/// How an estimate compares with the truth.
struct TerrainScore {
  int known = 0, right = 0;      ///< cells with a state and truth; whose state is true
  int missed = 0, invented = 0;  ///< obstacles called traversable; the reverse
  int seen = 0, seen_known = 0;  ///< cells over ground with ten points or more; with a state
  int sites = 0;
  int sites_on_obstacle =
      0;  ///< with anything but clear ground in their disc, beams 2.5 m up aside

  double right_share() const { return known > 0 ? static_cast<double>(right) / known : 0; }
  double known_share() const { return seen > 0 ? static_cast<double>(seen_known) / seen : 0; }
  void operator+=(const TerrainScore& other);
};

TerrainScore Score(const TerrainWorld& world, const Terrain& terrain,
                   const TerrainOptions& options);

}  // namespace rgbdt::study
