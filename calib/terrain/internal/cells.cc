#include "calib/terrain/internal/cells.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "calib/model/errors.h"

namespace rgbdt::terrain {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

void CheckCloud(const MapCloud& cloud) {
  const auto require = [&](std::size_t have, const char* what) {
    if (have == 0 || have == cloud.size()) return;
    throw InputError("terrain: the cloud has " + std::to_string(cloud.size()) + " points but " +
                     std::to_string(have) + " values of " + what);
  };
  require(cloud.temperature_k.size(), "temperature_k");
  require(cloud.count.size(), "count");
}

// Cell boundaries lie at multiples of the cell's size, so two clouds of a frame share them.
void LayOut(const MapCloud& cloud, const TerrainOptions& options, TerrainGrid* grid) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  Eigen::Vector2d low(kInf, kInf), high(-kInf, -kInf);
  for (const Eigen::Vector3f& point : cloud.points) {
    if (!point.allFinite()) continue;
    low = low.cwiseMin(point.head<2>().cast<double>());
    high = high.cwiseMax(point.head<2>().cast<double>());
  }
  if (!(low.x() <= high.x())) {
    throw InputError("terrain: none of " + std::to_string(cloud.size()) +
                     " points has finite coordinates");
  }
  const Eigen::Vector2d first = (low / options.cell_m).array().floor();
  const Eigen::Vector2d extent = ((high / options.cell_m).array().floor() - first.array()) + 1.0;
  if (extent.x() * extent.y() > static_cast<double>(options.max_cells)) {
    throw InputError("terrain: the points spread over " + std::to_string(high.x() - low.x()) +
                     " m x " + std::to_string(high.y() - low.y()) + " m, more than " +
                     std::to_string(options.max_cells) + " cells of " +
                     std::to_string(options.cell_m) + " m; take larger cells or cut the cloud");
  }
  grid->cell_m = options.cell_m;
  grid->origin = first * options.cell_m;
  grid->columns = static_cast<int>(extent.x());
  grid->rows = static_cast<int>(extent.y());
  const std::size_t n =
      static_cast<std::size_t>(grid->columns) * static_cast<std::size_t>(grid->rows);
  for (auto* values : {&grid->height_m, &grid->slope_rad, &grid->roughness_m, &grid->step_m,
                       &grid->temperature_k}) {
    values->assign(n, kNan);
  }
  grid->points.assign(n, 0);
  grid->state.assign(n, CellState::kUnknown);
  grid->interpolated.assign(n, 0);
  grid->overhead.assign(n, 0);
}

std::size_t CellOf(const TerrainGrid& grid, const Eigen::Vector3f& point) {
  const auto along = [&](double value, double origin, int count) {
    return std::clamp(static_cast<int>(std::floor((value - origin) / grid.cell_m)), 0, count - 1);
  };
  return grid.Index(along(double{point.x()}, grid.origin.x(), grid.columns),
                    along(double{point.y()}, grid.origin.y(), grid.rows));
}

CellPoint PointIn(const TerrainGrid& grid, std::size_t cell, const MapCloud& cloud, std::size_t i) {
  const Eigen::Vector2d aside = cloud.points[i].head<2>().cast<double>() - grid.Centre(cell);
  return {static_cast<float>(aside.x()), static_cast<float>(aside.y()), cloud.points[i].z(),
          cloud.temperature_k.empty() ? kNan : cloud.temperature_k[i],
          cloud.count.empty() ? 1 : cloud.count[i]};
}

}  // namespace

Cells SortIntoCells(const MapCloud& cloud, const TerrainOptions& options, TerrainGrid* grid) {
  CheckCloud(cloud);
  LayOut(cloud, options, grid);
  Cells cells;
  cells.begin.assign(grid->size() + 1, 0);
  for (const Eigen::Vector3f& point : cloud.points) {
    if (point.allFinite()) ++cells.begin[CellOf(*grid, point) + 1];
  }
  for (std::size_t cell = 0; cell < grid->size(); ++cell) {
    cells.begin[cell + 1] += cells.begin[cell];
  }
  std::vector<std::size_t> next(cells.begin.begin(), cells.begin.end() - 1);
  cells.points.resize(cells.begin.back());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud.points[i].allFinite()) continue;
    const std::size_t cell = CellOf(*grid, cloud.points[i]);
    cells.points[next[cell]++] = PointIn(*grid, cell, cloud, i);
  }
  for (std::size_t cell = 0; cell < grid->size(); ++cell) {
    const auto at = [&](std::size_t i) {
      return cells.points.begin() + static_cast<std::ptrdiff_t>(i);
    };
    std::stable_sort(at(cells.begin[cell]), at(cells.begin[cell + 1]),
                     [](const CellPoint& a, const CellPoint& b) { return a.z < b.z; });
    grid->points[cell] = static_cast<std::int32_t>(cells[cell].size());
  }
  return cells;
}

}  // namespace rgbdt::terrain
