#include "calib/detect/cloud/plane_regions.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

namespace rgbdt {

Plane PlaneSums::Fit() const {
  const Eigen::Vector3d mean = Mean();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(Scatter());
  Plane plane;
  plane.normal = solver.eigenvectors().col(0).normalized();
  plane.offset = plane.normal.dot(mean);
  if (plane.offset > 0) {
    plane.normal = -plane.normal;
    plane.offset = -plane.offset;
  }
  return plane;
}

double PlaneSums::Rms(const Plane& plane) const {
  return std::sqrt(std::max(0.0, plane.normal.dot(Scatter() * plane.normal)));
}

namespace {

// The grid at a stride: what regions are grown on.
class RegionFinder {
 public:
  RegionFinder(const RangeGrid& grid, const PlaneRegionOptions& options)
      : grid_(grid), options_(options) {
    // Twelve cells across the board's shorter side at the farthest range.
    const double cell = options.smallest_m / options.finest_range_m / 12;
    row_stride_ = Stride(cell, grid.row_step());
    column_stride_ = std::max(Stride(cell, grid.column_step()), grid.firing_columns());
    rows_ = (grid.rows() + row_stride_ - 1) / row_stride_;
    columns_ = grid.columns() / column_stride_;
    seen_.assign(static_cast<std::size_t>(rows_) * static_cast<std::size_t>(columns_), 0);
    tolerance_ = std::max(0.03, 3.5 * options.sigma_m);
  }

  std::vector<PlaneRegion> Find() {
    std::vector<PlaneRegion> regions;
    for (int row = 0; row < rows_; ++row) {
      for (int column = row % 2; column < columns_; column += 2) {
        if (seen_[Index(row, column)] != 0 || !IsHit(row, column)) continue;
        PlaneSums sums;
        if (!Seed(row, column, &sums)) continue;
        PlaneRegion region;
        if (Grow(row, column, &sums, &region)) regions.push_back(std::move(region));
      }
    }
    return regions;
  }

 private:
  static int Stride(double wanted, double step) {
    return step > 0 ? std::max(1, static_cast<int>(wanted / step)) : 1;
  }
  std::size_t Index(int row, int column) const {
    if (grid_.wraps()) column = ((column % columns_) + columns_) % columns_;
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  }
  // Of rings that fire in turn the next cell in which a beam was fired.
  std::size_t Cell(int row, int column) const {
    if (grid_.wraps()) column = ((column % columns_) + columns_) % columns_;
    const std::size_t cell = grid_.Cell(row * row_stride_, column * column_stride_);
    for (std::size_t k = 0; k < static_cast<std::size_t>(grid_.firing_columns()); ++k) {
      if (grid_.WasFired(cell + k)) return cell + k;
    }
    return cell;
  }
  bool Contains(int row, int column) const {
    return row >= 0 && row < rows_ && (grid_.wraps() || (column >= 0 && column < columns_));
  }
  bool IsHit(int row, int column) const { return grid_.IsHit(Cell(row, column)); }

  // Half a patch in cells.
  int Half(double range, double step, int stride, int most) const {
    if (!(step > 0)) return 1;
    return std::clamp(static_cast<int>(std::lround(options_.seed_m / (range * step * stride))), 1,
                      most);
  }

  // Whether the patch round a cell is plane, filled and not yet part of a region. Where no beam was
  // fired there is nothing to be filled.
  bool Seed(int row, int column, PlaneSums* sums) const {
    const double range = grid_.Point(Cell(row, column)).norm();
    if (!(range > 0.3) || range > options_.max_range_m) return false;
    const int half_rows = Half(range, grid_.row_step(), row_stride_, 4);
    const int half_columns = Half(range, grid_.column_step(), column_stride_, 8);
    const int column_step = half_columns > 4 ? 2 : 1;
    int looked = 0;
    std::array<Eigen::Vector3d, 200> points;
    int rows_hit = 0;
    for (int r = row - half_rows; r <= row + half_rows; ++r) {
      int hits = 0;
      for (int c = column - half_columns; c <= column + half_columns; c += column_step) {
        const bool contained = Contains(r, c);
        const std::size_t cell = contained ? Cell(r, c) : 0;
        if (contained && !grid_.WasFired(cell)) continue;
        ++looked;
        if (!contained || !grid_.IsHit(cell) || seen_[Index(r, c)] != 0) continue;
        const Eigen::Vector3d p = grid_.Point(cell).cast<double>();
        points[static_cast<std::size_t>(sums->count())] = p;
        sums->Add(p);
        ++hits;
      }
      if (hits > 0) ++rows_hit;
    }
    if (sums->count() < 6 || sums->count() * 10 < looked * 8 || rows_hit < 3) return false;
    const Plane plane = sums->Fit();
    if (sums->Rms(plane) > 1.6 * options_.sigma_m) return false;
    // A patch seen so flatly that it is all range noise has no direction.
    if (std::abs(plane.offset) < 0.1 * range) return false;
    return std::all_of(
        points.begin(), points.begin() + sums->count(),
        [&](const Eigen::Vector3d& p) { return std::abs(plane.Signed(p)) < tolerance_; });
  }

  struct Place {
    int row, column;
  };

  // Grows over neighbours, past single cells that are missing. False: not a board's size.
  bool Grow(int row, int column, PlaneSums* sums, PlaneRegion* region) {
    region->plane = sums->Fit();
    PlaneSums grown;
    std::vector<Place> places = {{row, column}};
    seen_[Index(row, column)] = 1;
    Eigen::Vector3f low = grid_.Point(Cell(row, column));
    Eigen::Vector3f high = low;
    int refit_at = 2 * sums->count();
    for (std::size_t next = 0; next < places.size(); ++next) {
      const Place at = places[next];
      const Eigen::Vector3f& here = grid_.Point(Cell(at.row, at.column));
      grown.Add(here.cast<double>());
      region->points.push_back(here);
      low = low.cwiseMin(here);
      high = high.cwiseMax(here);
      if (grown.count() == refit_at) {
        region->plane = grown.Fit();
        refit_at *= 2;
      }
      for (const auto& [dr, dc] : kNeighbours) {
        const int r = at.row + dr;
        const int c = at.column + dc;
        if (!Contains(r, c)) continue;
        char& seen = seen_[Index(r, c)];
        if (seen != 0) continue;
        const std::size_t cell = Cell(r, c);
        if (!grid_.IsHit(cell)) continue;
        const Eigen::Vector3f& p = grid_.Point(cell);
        if (std::abs(region->plane.Signed(p.cast<double>())) > tolerance_) continue;
        seen = 1;
        places.push_back({r, c});
      }
    }
    if (grown.count() < 6 || (high - low).maxCoeff() > options_.largest_m) return false;
    region->plane = grown.Fit();
    Bound(places, region);
    return region->last_column - region->first_column < grid_.columns();
  }

  void Bound(const std::vector<Place>& places, PlaneRegion* region) const {
    int low_row = places[0].row, high_row = low_row;
    int low_column = places[0].column, high_column = low_column;
    for (const Place& p : places) {
      low_row = std::min(low_row, p.row);
      high_row = std::max(high_row, p.row);
      low_column = std::min(low_column, p.column);
      high_column = std::max(high_column, p.column);
    }
    region->first_row = low_row * row_stride_;
    region->last_row = high_row * row_stride_;
    region->first_column = low_column * column_stride_;
    region->last_column = high_column * column_stride_;
  }

  static constexpr std::array<std::array<int, 2>, 6> kNeighbours = {
      {{0, 1}, {0, -1}, {1, 0}, {-1, 0}, {0, 2}, {0, -2}}};

  const RangeGrid& grid_;
  const PlaneRegionOptions& options_;
  int row_stride_ = 1, column_stride_ = 1;
  int rows_ = 0, columns_ = 0;
  double tolerance_ = 0.03;
  std::vector<char> seen_;
};

}  // namespace

std::vector<PlaneRegion> FindPlaneRegions(const RangeGrid& grid,
                                          const PlaneRegionOptions& options) {
  if (grid.rows() < 3 || grid.columns() < 3) return {};
  return RegionFinder(grid, options).Find();
}

}  // namespace rgbdt
