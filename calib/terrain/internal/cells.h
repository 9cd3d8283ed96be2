#pragma once

// Inside calib/terrain only: the points by cell.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "calib/terrain/terrain.h"

namespace rgbdt::terrain {

/// A point relative to the middle of its cell.
struct CellPoint {
  float x = 0, y = 0;     ///< [m]
  float z = 0;            ///< [m], the frame's own
  float temperature = 0;  ///< [K], NaN: unknown
  std::uint32_t count = 1;
};

/// A run of points.
struct Span {
  const CellPoint* first;
  const CellPoint* last;
  const CellPoint* begin() const { return first; }
  const CellPoint* end() const { return last; }
  std::size_t size() const { return static_cast<std::size_t>(last - first); }
};

/// All points, those of a cell together and the lowest first.
struct Cells {
  std::vector<CellPoint> points;
  std::vector<std::size_t> begin;  ///< of each cell; one more at the end

  Span operator[](std::size_t cell) const {
    return {points.data() + begin[cell], points.data() + begin[cell + 1]};
  }
};

/// Lays out `grid` (geometry, points; all else unknown) and sorts the cloud's points into it.
Cells SortIntoCells(const MapCloud& cloud, const TerrainOptions& options, TerrainGrid* grid);

/// Calls visit(neighbour's cell, columns aside, rows aside) for each cell within `reach` cells of
/// one, itself left out.
template <typename Visit>
void VisitAround(const TerrainGrid& grid, std::size_t cell, int reach, Visit visit) {
  const int column = static_cast<int>(cell % static_cast<std::size_t>(grid.columns));
  const int row = static_cast<int>(cell / static_cast<std::size_t>(grid.columns));
  for (int dr = -reach; dr <= reach; ++dr) {
    if (row + dr < 0 || row + dr >= grid.rows) continue;
    for (int dc = -reach; dc <= reach; ++dc) {
      if (column + dc < 0 || column + dc >= grid.columns || (dc == 0 && dr == 0)) continue;
      visit(grid.Index(column + dc, row + dr), dc, dr);
    }
  }
}

}  // namespace rgbdt::terrain
