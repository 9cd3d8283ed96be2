#include "calib/terrain/terrain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "calib/model/check.h"
#include "calib/model/errors.h"
#include "calib/terrain/internal/cells.h"
#include "calib/terrain/internal/ground.h"
#include "calib/terrain/internal/sites.h"
#include "calib/terrain/internal/surface.h"

namespace rgbdt {
namespace {

using terrain::Cells;
using terrain::Layers;
using terrain::Nearest;
using terrain::Patch;

// How far the ground is taken to go on under what occludes it [m].
constexpr float kGroundReach = 2;

// How wrong the ground's height may be where it is not seen, per metre.
constexpr double kUnseenSlope = 0.1;

struct Scene {
  Cells cells;
  std::vector<Patch> patches;
  std::vector<Layers> layers;        ///< over each cell's own ground, or that nearby
  std::vector<std::uint8_t> broken;  ///< 1: something stands in the cell
};

void MeasureGround(const TerrainOptions& options, Scene* scene, TerrainGrid* grid) {
  for (std::size_t cell = 0; cell < grid->size(); ++cell) {
    const Patch& patch = scene->patches[cell];
    if (!patch.known()) continue;
    const Layers layers =
        terrain::SortIntoLayers(scene->cells[cell], patch, {0, 0}, options.max_step_m, options);
    if (layers.on_ground < options.min_points) continue;
    scene->layers[cell] = layers;
    grid->height_m[cell] = patch.height;
    grid->slope_rad[cell] = std::atan(std::hypot(patch.gradient_x, patch.gradient_y));
    grid->roughness_m[cell] = static_cast<float>(layers.roughness_m);
  }
}

// Cells whose ground is hidden: over the nearest that is not too steep, gone on with.
void MeasureHidden(const TerrainOptions& options, Scene* scene, TerrainGrid* grid) {
  std::vector<std::uint8_t> level(grid->size());
  for (std::size_t cell = 0; cell < grid->size(); ++cell) {
    level[cell] = grid->slope_rad[cell] <= options.max_slope_rad;  // not so for NaN
  }
  const Nearest nearest = terrain::NearestMarked(level, *grid);
  for (std::size_t cell = 0; cell < grid->size(); ++cell) {
    if (!std::isnan(grid->height_m[cell]) || scene->cells[cell].size() == 0) continue;
    if (!(nearest.distance_m[cell] <= kGroundReach)) continue;
    const auto ground = static_cast<std::size_t>(nearest.cell[cell]);
    scene->layers[cell] = terrain::SortIntoLayers(
        scene->cells[cell], scene->patches[ground],
        (grid->Centre(cell) - grid->Centre(ground)).cast<float>(),
        options.max_step_m + kUnseenSlope * double{nearest.distance_m[cell]}, options);
  }
}

// Something stands in a cell. What stands at its very rim, beside a cell where more stands, is that
// one's: range noise carries a wall's points across.
void FindBroken(const TerrainOptions& options, Scene* scene, TerrainGrid* grid) {
  for (std::size_t cell = 0; cell < grid->size(); ++cell) {
    const Layers& layers = scene->layers[cell];
    grid->temperature_k[cell] = static_cast<float>(layers.temperature_k);
    grid->overhead[cell] = layers.overhead >= options.min_obstacle_points;
    if (layers.standing < options.min_obstacle_points) continue;
    bool spilt = false;
    if (layers.inside < options.min_obstacle_points) {
      terrain::VisitAround(*grid, cell, 1, [&](std::size_t other, int dc, int dr) {
        spilt |= dc * dr == 0 && scene->layers[other].standing > layers.standing;
      });
    }
    if (spilt) continue;
    scene->broken[cell] = 1;
    grid->step_m[cell] = static_cast<float>(layers.highest_m);
  }
}

// Between whole cells: where one holds the step itself, it is that one's alone.
void MeasureSteps(const Scene& scene, TerrainGrid* grid) {
  const auto cell_m = static_cast<float>(grid->cell_m);
  for (std::size_t cell = 0; cell < grid->size(); ++cell) {
    if (std::isnan(grid->height_m[cell]) || scene.broken[cell]) continue;
    float largest = 0;
    terrain::VisitAround(*grid, cell, 1, [&](std::size_t other, int dc, int dr) {
      if (std::isnan(grid->height_m[other]) || scene.broken[other]) return;
      const float expected =
          scene.patches[cell].At(static_cast<float>(dc) * cell_m, static_cast<float>(dr) * cell_m);
      largest = std::max(largest, std::abs(grid->height_m[other] - expected));
    });
    grid->step_m[cell] = largest;
  }
}

void Judge(const TerrainOptions& options, const Scene& scene, TerrainGrid* grid) {
  for (std::size_t cell = 0; cell < grid->size(); ++cell) {
    if (scene.broken[cell]) grid->state[cell] = CellState::kObstacle;
    if (scene.broken[cell] || std::isnan(grid->height_m[cell])) continue;
    const bool good = grid->slope_rad[cell] <= options.max_slope_rad &&
                      grid->step_m[cell] <= options.max_step_m &&
                      grid->roughness_m[cell] <= options.max_roughness_m;
    grid->state[cell] = good ? CellState::kTraversable : CellState::kObstacle;
  }
}

/// A cell's neighbours along x and along y that are in a state; -1: not.
struct Sides {
  std::int64_t pair[2][2] = {{-1, -1}, {-1, -1}};
  bool both(int axis) const { return pair[axis][0] >= 0 && pair[axis][1] >= 0; }
};

Sides SidesOf(const TerrainGrid& grid, const std::vector<CellState>& states, std::size_t cell,
              CellState state) {
  Sides sides;
  terrain::VisitAround(grid, cell, 1, [&](std::size_t other, int dc, int dr) {
    if (dc * dr != 0 || states[other] != state) return;
    sides.pair[dc != 0 ? 0 : 1][std::max(0, dc + dr)] = static_cast<std::int64_t>(other);
  });
  return sides;
}

// What lies between two obstacles and is narrower than the vehicle is no passage, and mostly the
// part of one obstacle that was not hit. `cells`: of one row or column, in order.
void CloseGaps(const std::vector<std::size_t>& cells, std::size_t widest,
               const std::vector<CellState>& seen, TerrainGrid* grid) {
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  std::size_t gap = kNone;  // traversable cells since the last obstacle
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (seen[cells[i]] == CellState::kTraversable) {
      gap += gap != kNone;
    } else if (seen[cells[i]] == CellState::kUnknown) {
      gap = kNone;
    } else {
      for (std::size_t k = 1; k <= gap && gap <= widest; ++k) {
        grid->state[cells[i - k]] = CellState::kObstacle;
      }
      gap = 0;
    }
  }
}

void CloseGaps(const TerrainOptions& options, TerrainGrid* grid) {
  const auto widest = static_cast<std::size_t>(options.vehicle_width_m / grid->cell_m);
  const std::vector<CellState> seen = grid->state;
  std::vector<std::size_t> cells;
  for (int row = 0; row < grid->rows; ++row) {
    cells.clear();
    for (int column = 0; column < grid->columns; ++column)
      cells.push_back(grid->Index(column, row));
    CloseGaps(cells, widest, seen, grid);
  }
  for (int column = 0; column < grid->columns; ++column) {
    cells.clear();
    for (int row = 0; row < grid->rows; ++row) cells.push_back(grid->Index(column, row));
    CloseGaps(cells, widest, seen, grid);
  }
}

// A cell that was hardly seen, between two that can be crossed and level with them.
void Interpolate(const TerrainOptions& options, TerrainGrid* grid) {
  const std::vector<CellState> seen = grid->state;
  const double most = options.max_step_m + 2 * grid->cell_m * std::tan(options.max_slope_rad);
  for (std::size_t cell = 0; cell < grid->size(); ++cell) {
    if (seen[cell] != CellState::kUnknown) continue;
    bool obstacle = false;
    terrain::VisitAround(*grid, cell, 1, [&](std::size_t other, int, int) {
      obstacle |= seen[other] == CellState::kObstacle;
    });
    if (obstacle) continue;
    const Sides sides = SidesOf(*grid, seen, cell, CellState::kTraversable);
    for (int axis = 0; axis < 2; ++axis) {
      if (!sides.both(axis)) continue;
      const float one = grid->height_m[static_cast<std::size_t>(sides.pair[axis][0])];
      const float other = grid->height_m[static_cast<std::size_t>(sides.pair[axis][1])];
      if (std::abs(one - other) > most) continue;
      grid->state[cell] = CellState::kTraversable;
      grid->interpolated[cell] = 1;
      grid->height_m[cell] = (one + other) / 2;
      break;
    }
  }
}

}  // namespace

void TerrainOptions::Check() const {
  const OptionCheck check("terrain");
  const auto metres = [&](double value, const char* field) {
    check.Require(value > 0 && value <= 1000, field, value, "above 0, up to 1000 m");
  };
  check.Require(cell_m >= 0.02 && cell_m <= 10, "cell_m", cell_m, "0.02 to 10 m");
  check.Require(max_slope_rad > 0 && max_slope_rad < 1.2, "max_slope_rad", max_slope_rad,
                "above 0, below 1.2 rad");
  check.Require(site_max_slope_rad > 0 && site_max_slope_rad < 1.2, "site_max_slope_rad",
                site_max_slope_rad, "above 0, below 1.2 rad");
  metres(max_step_m, "max_step_m");
  metres(max_roughness_m, "max_roughness_m");
  metres(vehicle_width_m, "vehicle_width_m");
  metres(vehicle_height_m, "vehicle_height_m");
  check.Require(vehicle_height_m > max_step_m, "vehicle_height_m", vehicle_height_m,
                "more than max_step_m");
  metres(site_radius_m, "site_radius_m");
  metres(site_headroom_m, "site_headroom_m");
  check.Require(min_points >= 1 && min_points <= 1000, "min_points", min_points, "1 to 1000");
  check.Require(min_obstacle_points >= 1 && min_obstacle_points <= 1000, "min_obstacle_points",
                min_obstacle_points, "1 to 1000");
  check.Require(max_sites >= 0 && max_sites <= 1000, "max_sites", max_sites, "0 to 1000");
  check.Require(max_cells >= 1 && max_cells <= 100'000'000, "max_cells",
                static_cast<double>(max_cells), "1 to 1e8");
}

Eigen::Vector2d TerrainGrid::Centre(std::size_t cell) const {
  const std::size_t n = static_cast<std::size_t>(columns);
  const std::size_t column = cell % n;
  const std::size_t row = cell / n;
  return origin + cell_m * Eigen::Vector2d(static_cast<double>(column) + 0.5,
                                           static_cast<double>(row) + 0.5);
}

Terrain FindTerrain(const MapCloud& cloud, const TerrainOptions& options) {
  options.Check();
  Terrain terrain;
  TerrainGrid& grid = terrain.grid;
  Scene scene;
  scene.cells = terrain::SortIntoCells(cloud, options, &grid);
  const std::vector<float> lowest = terrain::LowestHeights(scene.cells, grid, options);
  const std::vector<std::uint8_t> ground = terrain::FindGround(lowest, grid, options);
  scene.patches = terrain::FitPatches(scene.cells, lowest, ground, grid, options);
  scene.layers.resize(grid.size());
  scene.broken.assign(grid.size(), 0);
  MeasureGround(options, &scene, &grid);
  MeasureHidden(options, &scene, &grid);
  FindBroken(options, &scene, &grid);
  MeasureSteps(scene, &grid);
  Judge(options, scene, &grid);
  CloseGaps(options, &grid);
  Interpolate(options, &grid);
  terrain.sites = terrain::FindSites(grid, options);
  return terrain;
}

}  // namespace rgbdt
