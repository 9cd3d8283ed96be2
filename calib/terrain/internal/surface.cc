#include "calib/terrain/internal/surface.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/model/statistics.h"

namespace rgbdt::terrain {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr double kReach = 0.7;  // [m] a gradient is that of the cells so far around
constexpr double kLag = 0.2;    // [m] between two heights whose difference is taken
constexpr std::size_t kLeastDifferences = 3, kLeastCells = 6;
constexpr double kLeastTolerance = 0.02;  // [m] what a cell's height may always be off a plane

int CellsIn(double metres, const TerrainGrid& grid, int least, int most) {
  return std::clamp(static_cast<int>(std::lround(metres / grid.cell_m)), least, most);
}

struct Neighbour {
  double x, y, height;
};

// Heights around a cell, row after row; NaN where there is none.
struct Window {
  int reach;
  std::vector<double> heights;
  double& At(int dc, int dr) {
    return heights[static_cast<std::size_t>((dr + reach) * (2 * reach + 1) + dc + reach)];
  }
};

Window WindowAround(const std::vector<float>& heights, const TerrainGrid& grid, std::size_t cell) {
  Window window{CellsIn(kReach, grid, 2, 7), {}};
  window.heights.assign(static_cast<std::size_t>((2 * window.reach + 1) * (2 * window.reach + 1)),
                        std::numeric_limits<double>::quiet_NaN());
  window.At(0, 0) = heights[cell];
  VisitAround(grid, cell, window.reach,
              [&](std::size_t other, int dc, int dr) { window.At(dc, dr) = heights[other]; });
  return window;
}

// The medians of the differences along x and along y: one step among level ground is outvoted.
Eigen::Vector2d MedianGradient(Window* window, const TerrainGrid& grid) {
  const int lag = CellsIn(kLag, grid, 1, window->reach);
  std::vector<double> along_x, along_y;
  for (int dr = -window->reach; dr <= window->reach; ++dr) {
    for (int dc = -window->reach; dc <= window->reach; ++dc) {
      const double here = window->At(dc, dr);
      if (std::isnan(here)) continue;
      if (dc + lag <= window->reach && !std::isnan(window->At(dc + lag, dr))) {
        along_x.push_back(window->At(dc + lag, dr) - here);
      }
      if (dr + lag <= window->reach && !std::isnan(window->At(dc, dr + lag))) {
        along_y.push_back(window->At(dc, dr + lag) - here);
      }
    }
  }
  if (std::min(along_x.size(), along_y.size()) < kLeastDifferences) {
    return Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  }
  return Eigen::Vector2d(Median(std::move(along_x)), Median(std::move(along_y))) /
         (lag * grid.cell_m);
}

// Least squares over the cells that lie near the plane with this gradient through the middle one;
// NaN where they are too few or in a line.
Eigen::Vector2d Refined(const Eigen::Vector2d& gradient, Window* window, const TerrainGrid& grid) {
  std::vector<Neighbour> cells;
  std::vector<double> off;
  for (int dr = -window->reach; dr <= window->reach; ++dr) {
    for (int dc = -window->reach; dc <= window->reach; ++dc) {
      const double height = window->At(dc, dr) - window->At(0, 0);
      if (std::isnan(height)) continue;
      const double x = dc * grid.cell_m, y = dr * grid.cell_m;
      cells.push_back({x, y, height});
      off.push_back(std::abs(height - gradient.dot(Eigen::Vector2d(x, y))));
    }
  }
  const double tolerance = std::max(kLeastTolerance, 3 * 1.4826 * Median(off));
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  std::size_t used = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (off[i] > tolerance) continue;
    const Eigen::Vector3d row(cells[i].x, cells[i].y, 1);
    normal += row * row.transpose();
    right += row * cells[i].height;
    ++used;
  }
  const double spread = grid.cell_m * grid.cell_m * static_cast<double>(used);
  if (used < kLeastCells ||
      normal.determinant() < 1e-3 * spread * spread * static_cast<double>(used)) {
    return Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  }
  return (normal.inverse() * right).head<2>();
}

void SetGradients(const std::vector<std::uint8_t>& ground, const TerrainGrid& grid,
                  std::vector<Patch>* patches) {
  std::vector<float> heights(grid.size(), kNan);
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    if (ground[cell]) heights[cell] = (*patches)[cell].height;
  }
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    if (!ground[cell]) continue;
    Window window = WindowAround(heights, grid, cell);
    Eigen::Vector2d gradient = MedianGradient(&window, grid);
    if (gradient.allFinite()) gradient = Refined(gradient, &window, grid);
    (*patches)[cell].gradient_x = static_cast<float>(gradient.x());
    (*patches)[cell].gradient_y = static_cast<float>(gradient.y());
  }
}

// The median of the points on the lowest level, the slope taken out.
float HeightOf(const Span& points, const Patch& patch, double band_m) {
  std::vector<double> levels;
  levels.reserve(points.size());
  for (const CellPoint& point : points) {
    levels.push_back(point.z - patch.gradient_x * point.x - patch.gradient_y * point.y);
  }
  std::sort(levels.begin(), levels.end());
  const std::size_t rank = levels.size() < 3 ? 0 : std::max<std::size_t>(1, levels.size() / 10);
  const auto top = std::upper_bound(levels.begin(), levels.end(), levels[rank] + band_m);
  return static_cast<float>(levels[static_cast<std::size_t>(top - levels.begin()) / 2]);
}

}  // namespace

bool Patch::known() const {
  return std::isfinite(height) && std::isfinite(gradient_x) && std::isfinite(gradient_y);
}

std::vector<Patch> FitPatches(const Cells& cells, const std::vector<float>& lowest,
                              const std::vector<std::uint8_t>& ground, const TerrainGrid& grid,
                              const TerrainOptions& options) {
  std::vector<Patch> patches(grid.size(), {kNan, kNan, kNan});
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    if (ground[cell]) patches[cell].height = lowest[cell];
  }
  // Heights need the slope within a cell, the slope needs heights: once roughly, once well.
  SetGradients(ground, grid, &patches);
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    if (!patches[cell].known()) continue;
    patches[cell].height = HeightOf(cells[cell], patches[cell], options.max_step_m);
  }
  SetGradients(ground, grid, &patches);
  return patches;
}

Layers SortIntoLayers(const Span& points, const Patch& patch, const Eigen::Vector2f& aside,
                      double step_m, const TerrainOptions& options) {
  const double rim = (0.5 - kBorder) * options.cell_m;
  Layers layers;
  double squares = 0, temperatures = 0;
  std::int64_t warm = 0, from_top = 0;
  for (const CellPoint* point = points.last; point != points.first;) {
    --point;  // the highest first
    const double above = point->z - patch.At(point->x + aside.x(), point->y + aside.y());
    const std::int64_t count = point->count;
    if (above > options.vehicle_height_m) {
      if (above < options.site_headroom_m) layers.overhead += count;
      continue;
    }
    if (from_top < options.min_obstacle_points) layers.highest_m = above;
    from_top += count;
    if (above > step_m) {
      layers.standing += count;
      const float from_middle = std::max(std::abs(point->x), std::abs(point->y));
      if (from_middle < rim) layers.inside += count;
    } else if (above >= -step_m) {
      layers.on_ground += count;
      squares += static_cast<double>(count) * above * above;
    }
    if (std::isfinite(point->temperature)) {
      temperatures += static_cast<double>(count) * double{point->temperature};
      warm += count;
    }
  }
  layers.roughness_m = layers.on_ground > 0
                           ? std::sqrt(squares / static_cast<double>(layers.on_ground))
                           : double{kNan};
  layers.temperature_k = warm > 0 ? temperatures / static_cast<double>(warm) : double{kNan};
  return layers;
}

}  // namespace rgbdt::terrain
