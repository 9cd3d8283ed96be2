#include "calib/methods/edge_grid/depth_jumps.h"

#include <algorithm>
#include <cmath>

#include "calib/detect/cloud/range_grid.h"

namespace rgbdt {
namespace {

double RangeIn(const RangeGrid& grid, std::size_t cell) {
  return (grid.Point(cell).cast<double>() - grid.Origin(cell)).norm();
}

double FarthestIn(const RangeGrid& grid) {
  double farthest = 0;
  for (int row = 0; row < grid.rows(); ++row) {
    for (int column = 0; column < grid.columns(); ++column) {
      const std::size_t cell = grid.Cell(row, column);
      if (grid.IsHit(cell)) farthest = std::max(farthest, RangeIn(grid, cell));
    }
  }
  return farthest;
}

// How far the point in a cell stands before what another beam met [m]; 0 where it does not, or
// where no beam is known to have been fired.
double StepTo(const RangeGrid& grid, double range, double farthest, int row, int column) {
  if (!grid.Contains(row, column)) return 0;
  const std::size_t cell = grid.Cell(row, column);
  if (!grid.IsHit(cell) && !grid.Direction(cell)) return 0;
  return std::max(0.0, (grid.IsHit(cell) ? RangeIn(grid, cell) : farthest) - range);
}

// How much beams rise from one column to the next, or from one row to the next, all in all.
double RiseAlong(const RangeGrid& grid, int rows, int columns) {
  double sum = 0;
  int count = 0;
  for (int row = 0; row + rows < grid.rows(); ++row) {
    for (int column = 0; column + columns < grid.columns(); ++column) {
      const auto here = grid.Direction(grid.Cell(row, column));
      const auto next = grid.Direction(grid.Cell(row + rows, column + columns));
      if (!here || !next || !((*next - *here).norm() > 0)) continue;
      sum += std::abs(next->z() - here->z()) / (*next - *here).norm();
      ++count;
    }
  }
  return count > 0 ? sum / count : 1;
}

}  // namespace

std::vector<DepthJump> DepthJumpsOf(const Cloud& cloud, double least_m) {
  const RangeGrid grid(cloud);
  if (grid.hits() == 0) return {};
  const double farthest = FarthestIn(grid);
  const bool across_rows = RiseAlong(grid, 1, 0) < RiseAlong(grid, 0, 1);
  const int dr = across_rows ? 1 : 0;
  const int dc = 1 - dr;
  std::vector<DepthJump> edges;
  for (int row = 0; row < grid.rows(); ++row) {
    for (int column = 0; column < grid.columns(); ++column) {
      const std::size_t cell = grid.Cell(row, column);
      if (!grid.IsHit(cell)) continue;
      const double range = RangeIn(grid, cell);
      const double step = std::max(StepTo(grid, range, farthest, row - dr, column - dc),
                                   StepTo(grid, range, farthest, row + dr, column + dc));
      if (step > least_m) {
        edges.push_back({grid.Point(cell), static_cast<float>(std::sqrt(step))});
      }
    }
  }
  return edges;
}

}  // namespace rgbdt
