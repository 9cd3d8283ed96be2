#include "calib/detect/cloud/range_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "calib/detect/cloud/internal/ring_rows.h"
#include "calib/model/statistics.h"

namespace rgbdt {
namespace {

using Angles = RangeGrid::Angles;

using Rows = RangeGrid::Rows;

// Width of even cells a little wider than the points are apart, so that few of them stay empty by
// chance.
double CellStep(const std::vector<Angles>& angles) {
  constexpr double kCoarse = M_PI / 180;
  std::vector<char> seen(360 * 181, 0);
  double solid = 0;
  for (const Angles& a : angles) {
    const int column = std::clamp(static_cast<int>((a.azimuth + M_PI) / kCoarse), 0, 359);
    const int row = std::clamp(static_cast<int>((a.elevation + M_PI / 2) / kCoarse), 0, 180);
    char& cell = seen[static_cast<std::size_t>(row * 360 + column)];
    if (cell == 0) solid += kCoarse * kCoarse;
    cell = 1;
  }
  return 1.5 * std::sqrt(solid / static_cast<double>(std::max<std::size_t>(1, angles.size())));
}

Rows ByCells(const std::vector<Angles>& angles, double step) {
  Rows rows(static_cast<std::size_t>(M_PI / step) + 2);
  for (const Angles& a : angles) {
    rows[static_cast<std::size_t>((a.elevation + M_PI / 2) / step)].push_back(a);
  }
  while (!rows.empty() && rows.back().empty()) rows.pop_back();
  const auto used =
      std::find_if(rows.begin(), rows.end(), [](const auto& r) { return !r.empty(); });
  rows.erase(rows.begin(), used);
  return rows;
}

// The azimuth step that most of the neighbours in a row are apart: their median, made finer by
// counting steps over whole stretches of a row.
double AzimuthStep(const Rows& rows) {
  std::vector<double> steps;
  for (const auto& row : rows) {
    for (std::size_t i = 1; i < row.size() && steps.size() < 200000; ++i) {
      const double d = row[i].azimuth - row[i - 1].azimuth;
      if (d > 1e-6) steps.push_back(d);
    }
  }
  const double rough = Median(std::move(steps));
  if (!(rough > 0)) return 0;
  double total = 0;
  double count = 0;
  for (const auto& row : rows) {
    for (std::size_t i = 1; i < row.size(); ++i) {
      const double d = row[i].azimuth - row[i - 1].azimuth;
      const double n = std::round(d / rough);
      if (n < 1 || n > 3 || std::abs(d - n * rough) > 0.25 * rough) continue;
      total += d;
      count += n;
    }
  }
  return count > 0 ? total / count : rough;
}

// Where a row's columns lie, as a fraction of a step: the circular mean.
double PhaseOf(const std::vector<Angles>& row, double step) {
  double c = 0;
  double s = 0;
  for (const Angles& a : row) {
    const double turn = 2 * M_PI * (a.azimuth + M_PI) / step;
    c += std::cos(turn);
    s += std::sin(turn);
  }
  return std::atan2(s, c) / (2 * M_PI) * step;
}

}  // namespace

RangeGrid::RangeGrid(const Cloud& cloud, double coarser) : cloud_(&cloud) {
  bool lines_known = cloud.organised && cloud.lines > 1 && cloud.beams > 1;
  if (lines_known &&
      cloud.directions.size() != cloud.size()) {  // full of hits it needs no directions
    lines_known = std::all_of(cloud.points.begin(), cloud.points.end(),
                              [](const Eigen::Vector3f& p) { return p.allFinite(); });
  }
  if (lines_known) {
    TakeAsItIs();
  } else {
    Rebuild(coarser);
  }
}

void RangeGrid::TakeAsItIs() {
  rows_ = cloud_->lines;
  columns_ = cloud_->beams;
  for (std::size_t i = 0; i < cloud_->size(); ++i) hits_ += cloud_->IsHit(i) ? 1 : 0;
  MeasureSteps();
  MeasureTurns();
  std::size_t first = Cell(rows_ / 2, 0);
  std::size_t last = Cell(rows_ / 2, columns_ - 1);
  int skipped = 0, at_end = 0;
  for (; skipped + 1 < firing_columns_ && !WasFired(first); ++skipped) ++first;
  for (; at_end + 1 < firing_columns_ && !WasFired(last); ++at_end) --last;
  const auto from = Direction(first);
  const auto to = Direction(last);
  wraps_ =
      from && to && columns_ > 100 &&
      std::acos(std::clamp(from->dot(*to), -1.0, 1.0)) < (skipped + at_end + 2.5) * column_step_;
}

// Of each row the shortest way from beam to beam that is no exception. Of a grid that was put back
// together only hits are known.
void RangeGrid::MeasureTurns() {
  constexpr int kEnough = 20;
  std::vector<int> turns(static_cast<std::size_t>(rows_), 1);
  for (int row = 0; row < rows_; ++row) {
    std::array<int, kMostTurns + 1> ways{};
    int count = 0;
    int last = -kMostTurns - 1;
    for (int column = 0; column < columns_; ++column) {
      const std::size_t cell = Cell(row, column);
      if (place_.empty() ? !WasFired(cell) : !IsHit(cell)) continue;
      if (column - last <= kMostTurns) {
        ++ways[static_cast<std::size_t>(column - last)];
        ++count;
      }
      last = column;
    }
    int& turn = turns[static_cast<std::size_t>(row)];
    while (count >= kEnough && 10 * ways[static_cast<std::size_t>(turn)] < count) ++turn;
    firing_columns_ = std::max(firing_columns_, turn);
  }
  row_turns_ = std::move(turns);
}

bool RangeGrid::WasFired(std::size_t cell) const {
  if (IsHit(cell)) return true;
  if (place_.empty()) return cloud_->directions[cell].allFinite();
  if (row_turns_.empty()) return true;
  const auto columns = static_cast<std::size_t>(columns_);
  const auto row = static_cast<int>(cell / columns), column = static_cast<int>(cell % columns);
  for (int k = 1; k < row_turns_[static_cast<std::size_t>(row)]; ++k) {
    for (const int beside : {column - k, column + k}) {
      if (Contains(row, beside) && IsHit(Cell(row, beside))) return false;
    }
  }
  return true;
}

void RangeGrid::MeasureSteps() {
  std::vector<double> along;
  std::vector<double> across;
  const std::size_t n = static_cast<std::size_t>(rows_) * static_cast<std::size_t>(columns_);
  const std::size_t stride = std::max<std::size_t>(1, n / 4001) | 1;
  const auto angle = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::asin(std::min(1.0, a.cross(b).norm()));
  };
  // To the next beam that was fired, as often a step as it is cells away.
  const auto measure = [&](std::size_t cell, std::size_t step, std::size_t cells,
                           std::vector<double>* steps) {
    for (std::size_t k = 1; k <= std::min<std::size_t>(cells, kMostTurns); ++k) {
      if (const auto next = Direction(cell + k * step)) {
        return steps->push_back(angle(*Direction(cell), *next) / static_cast<double>(k));
      }
    }
  };
  const auto columns = static_cast<std::size_t>(columns_);
  for (std::size_t cell = 0; cell < n; cell += stride) {
    if (!WasFired(cell)) continue;
    measure(cell, 1, columns - 1 - cell % columns, &along);
    measure(cell, columns, (n - 1 - cell) / columns, &across);
  }
  column_step_ = Median(std::move(along));
  row_step_ = Median(std::move(across));
}

void RangeGrid::Rebuild(double coarser) {
  const std::vector<Angles> angles = AnglesOf(*cloud_);
  hits_ = static_cast<int>(angles.size());
  if (angles.size() < 100) return;
  // A turned scanner has hundreds of beams, and its centre moves: its points keep to no such grid.
  // Nor do those of which too many share a cell.
  if (const auto found = FindRingRows(*cloud_, angles)) {
    const auto crowded = Place(found->rows, AzimuthStep(found->rows), false);
    misnumbered_ = found->misnumbered;
    crowded_ = found->shared;
    if (crowded && *crowded * 50 < hits_) return MeasureTurns();
    if (crowded) crowded_ = std::max(crowded_, static_cast<double>(*crowded) / hits_);
  }
  scattered_ = true;
  double step = coarser * CellStep(angles);
  while (!Place(ByCells(angles, step), step, true)) step *= 1.5;
}

std::optional<int> RangeGrid::Place(const Rows& rows, double step, bool even) {
  if (!(step > 1e-6)) return std::nullopt;
  float low = 4;
  float high = -4;
  for (const auto& row : rows) {
    for (const Angles& a : row) {
      low = std::min(low, a.azimuth);
      high = std::max(high, a.azimuth);
    }
  }
  wraps_ = high - low > 2 * M_PI - 0.1;
  const double first = wraps_ ? -M_PI : low - 0.5 * step;
  rows_ = static_cast<int>(rows.size());
  columns_ =
      static_cast<int>(std::lround((wraps_ ? 2 * M_PI : high - low) / step)) + (wraps_ ? 0 : 2);
  // A few stray points between dense ones must not make a grid of nothing but misses.
  if (static_cast<double>(rows_) * columns_ > 20.0 * hits_ + 1e6) return std::nullopt;
  place_.assign(static_cast<std::size_t>(rows_) * static_cast<std::size_t>(columns_), -1);
  next_.assign(cloud_->size(), -1);
  row_elevation_.clear();
  row_azimuth_.clear();
  std::vector<double> elevations;
  int crowded = 0;
  for (int r = 0; r < rows_; ++r) {
    const auto& row = rows[static_cast<std::size_t>(r)];
    row_elevation_.push_back(row.empty() ? row_elevation_.back() + step : MedianElevation(row));
    if (r > 0) elevations.push_back(row_elevation_.back() - row_elevation_.end()[-2]);
    const double phase = even ? 0.5 * step : PhaseOf(row, step);
    // Column 0 lies within half a step of `first`.
    row_azimuth_.push_back(first + std::remainder(-M_PI + phase - first, step));
    for (const Angles& a : row) {
      const int column = static_cast<int>(std::lround((a.azimuth - row_azimuth_.back()) / step));
      if (!Contains(r, column)) continue;
      std::int32_t& place = place_[Cell(r, column)];
      if (place >= 0) {
        ++crowded;
        next_[static_cast<std::size_t>(a.point)] = next_[static_cast<std::size_t>(place)];
        next_[static_cast<std::size_t>(place)] = a.point;
      } else {
        place = a.point;
      }
    }
  }
  column_step_ = step;
  row_step_ = Median(std::move(elevations));
  return crowded;
}

Eigen::Vector3d RangeGrid::Origin(std::size_t cell) const {
  if (cloud_->origins.empty() || !place_.empty()) return Eigen::Vector3d::Zero();
  return cloud_->origins[cell / static_cast<std::size_t>(columns_)].cast<double>();
}

std::optional<Eigen::Vector3d> RangeGrid::Direction(std::size_t cell) const {
  if (IsHit(cell)) return (Point(cell).cast<double>() - Origin(cell)).normalized();
  if (place_.empty()) {
    if (cloud_->directions.size() != cloud_->size()) return std::nullopt;
    const Eigen::Vector3f& d = cloud_->directions[cell];
    if (!d.allFinite()) return std::nullopt;
    return d.cast<double>().normalized();
  }
  if (!WasFired(cell)) return std::nullopt;
  const std::size_t row = cell / static_cast<std::size_t>(columns_);
  const double azimuth =
      row_azimuth_[row] +
      static_cast<double>(cell % static_cast<std::size_t>(columns_)) * column_step_;
  const double elevation = row_elevation_[row];
  return Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth),
                         std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
}

}  // namespace rgbdt
