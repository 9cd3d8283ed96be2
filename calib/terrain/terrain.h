#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "calib/model/map_cloud.h"

namespace rgbdt {

/// What drives or lands there, and how finely to look. The defaults are those of a small wheeled
/// rover: 0.6 m long, 0.5 m wide, wheels of 0.25 m, a mast of less than 1.5 m.
struct TerrainOptions {
  double cell_m = 0.2;               ///< edge of a cell [m], 0.02 to 10
  double max_slope_rad = 0.349;      ///< 20 degrees; below 1.2
  double max_step_m = 0.10;          ///< what a wheel climbs, and what stands up to here
  double max_roughness_m = 0.05;     ///< RMS of a cell's ground about its plane
  double vehicle_width_m = 0.5;      ///< gaps between obstacles that are narrower are closed
  double vehicle_height_m = 1.5;     ///< what hangs higher above the ground is passed under
  int min_points = 3;                ///< on the ground of a cell; with fewer it is unknown
  int min_obstacle_points = 2;       ///< that make an obstacle: a single one is a stray
  double site_radius_m = 1;          ///< of a landing site, at least
  double site_max_slope_rad = 0.26;  ///< 15 degrees: a steeper place is no site
  double site_headroom_m = 20;       ///< nothing may hang over a site up to here
  int max_sites = 10;
  std::size_t max_cells = 4'000'000;  ///< some 300 bytes each while it works

  /// Throws InputError naming the field and its value.
  void Check() const;
};

enum class CellState : std::uint8_t { kUnknown = 0, kTraversable = 1, kObstacle = 2 };

/// Cells over x and y. All vectors are row after row: cell (column, row) is at row * columns +
/// column, its lowest corner at origin + cell_m * (column, row). NaN: not known.
struct TerrainGrid {
  double cell_m = 0;
  Eigen::Vector2d origin{0, 0};  ///< lowest corner of cell (0, 0) [m]
  int columns = 0, rows = 0;     ///< along x, along y
  std::vector<float> height_m;   ///< of the ground at the cell's middle
  std::vector<float> slope_rad;
  std::vector<float> roughness_m;
  std::vector<float> step_m;
  std::vector<float> temperature_k;  ///< mean of the points below the vehicle's height
  std::vector<std::int32_t> points;  ///< all, whatever their height
  std::vector<CellState> state;
  std::vector<std::uint8_t> interpolated;  ///< 1: traversable because its neighbours are
  std::vector<std::uint8_t> overhead;      ///< 1: something hangs over it, within site_headroom_m

  std::size_t size() const { return state.size(); }
  std::size_t Index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(column);
  }
  /// Middle of a cell [m].
  Eigen::Vector2d Centre(std::size_t cell) const;
};

/// A disc to land on, wholly within traversable cells that were seen.
struct LandingSite {
  Eigen::Vector3d centre{0, 0, 0};  ///< on the ground [m]
  double radius_m = 0;              ///< the largest that fits round the centre
  double slope_rad = 0;             ///< of the plane through the disc's cells
  double roughness_m = 0;           ///< RMS of cells' heights and their own roughness about it
  double clearance_m = 0;           ///< centre to the nearest obstacle or overhang; infinite: none
  double temperature_k = 0;         ///< mean; NaN: unknown
  double score = 0;                 ///< 0 to 1
};

struct Terrain {
  TerrainGrid grid;
  std::vector<LandingSite> sites;  ///< best first; no two overlap
};

/// Slope, roughness, step and temperature of the ground, where a vehicle can drive and where it can
/// land: README.md beside this file has the definitions, formulas and sources. `cloud` is a map or
/// a sweep in a frame whose z points up; only points, temperature and count are used. The same
/// input gives the same output. Throws InputError for a cloud without points, one whose vectors
/// differ in length, or one spread over more than max_cells.
Terrain FindTerrain(const MapCloud& cloud, const TerrainOptions& options);

}  // namespace rgbdt
