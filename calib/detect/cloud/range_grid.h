#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "calib/model/cloud.h"

namespace rgbdt {

/// Rings that fire in turn fire again after so many columns at most.
inline constexpr int kMostTurns = 4;

/// A cloud as the sensor saw it: beams in rows and columns, neighbours in the grid being neighbours
/// in angle. An organised cloud that tells the directions of its misses is taken as it is (line x
/// beam). Any other is put back into ring x azimuth: by its rings where it has them, by the
/// elevations that its points keep to, or, where they keep to none, in even cells of angle. There
/// an empty cell is a beam that returned nothing, but for those between the hits of a row that has
/// one in every second column or fewer: its ring fired in turn. LIDAR frame, metres.
class RangeGrid {
 public:
  /// `cloud` outlives the grid. Cells that the points keep to no rows in are so many times wider.
  explicit RangeGrid(const Cloud& cloud, double coarser = 1);

  const Cloud& cloud() const { return *cloud_; }
  int rows() const { return rows_; }
  int columns() const { return columns_; }
  /// The cells are even ones of angle, as the points keep to no rows.
  bool scattered() const { return scattered_; }
  /// The part of the points that share a beam with others and could not be told apart, where that
  /// puts the grid in doubt; else 0.
  double crowded() const { return crowded_; }
  /// The cloud's ring numbers are not those of the rings that its points keep to.
  bool misnumbered() const { return misnumbered_; }
  /// From a beam of a row to the next one that was fired, in columns, of the row where that is
  /// farthest: 1, or, where rings fire in turn, up to kMostTurns.
  int firing_columns() const { return firing_columns_; }
  /// Columns go round: column -1 is the last one.
  bool wraps() const { return wraps_; }
  /// Median angle between neighbours [rad]; 0: fewer than two rows (columns).
  double row_step() const { return row_step_; }
  double column_step() const { return column_step_; }

  /// Whether there is such a cell. The column may lie beyond the grid's limits where it wraps.
  bool Contains(int row, int column) const {
    return row >= 0 && row < rows_ && (wraps_ || (column >= 0 && column < columns_));
  }
  /// Index of a cell; it must be contained.
  std::size_t Cell(int row, int column) const {
    if (wraps_) column = ((column % columns_) + columns_) % columns_;
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  }
  bool IsHit(std::size_t cell) const {
    const std::int64_t i = PointOf(cell);
    return i >= 0 && std::isfinite(cloud_->points[static_cast<std::size_t>(i)].x());
  }
  /// Whether a beam was fired there as far as one knows: one that returned nothing says that
  /// nothing is there, one that was not fired (rings that fire in turn, a lost packet) says
  /// nothing.
  bool WasFired(std::size_t cell) const;
  /// The point of a hit.
  const Eigen::Vector3f& Point(std::size_t cell) const {
    return cloud_->points[static_cast<std::size_t>(PointOf(cell))];
  }
  /// All the points of a cell and their indices in the cloud: where the grid is coarser than the
  /// points, there are several, and which of them comes first depends on their noise.
  template <typename F>
  void ForEachPoint(std::size_t cell, F f) const {
    if (place_.empty()) {
      if (IsHit(cell)) f(cloud_->points[cell], cell);
      return;
    }
    for (std::int32_t i = place_[cell]; i >= 0; i = next_[static_cast<std::size_t>(i)]) {
      f(cloud_->points[static_cast<std::size_t>(i)], static_cast<std::size_t>(i));
    }
  }
  /// Where the beam starts.
  Eigen::Vector3d Origin(std::size_t cell) const;
  /// Unit direction of the beam; nothing where it is not known.
  std::optional<Eigen::Vector3d> Direction(std::size_t cell) const;
  /// How many points the cloud has.
  int hits() const { return hits_; }

  /// Where a point is seen from the sensor's origin.
  struct Angles {
    float azimuth = 0, elevation = 0;  ///< [rad]
    std::int32_t point = 0;
    bool again = false;  ///< the LIDAR has been round once before in this cloud
  };
  /// Points that belong to one row each, lowest row first.
  using Rows = std::vector<std::vector<Angles>>;

 private:
  std::int64_t PointOf(std::size_t cell) const {
    return place_.empty() ? static_cast<std::int64_t>(cell) : place_[cell];
  }
  void TakeAsItIs();
  void Rebuild(double coarser);
  // Puts rows into columns a step apart; how many points found their cell taken. Nothing: the grid
  // would have far more cells than the cloud has points.
  std::optional<int> Place(const Rows& rows, double step, bool even);
  void MeasureSteps();
  void MeasureTurns();

  const Cloud* cloud_;
  int rows_ = 0, columns_ = 0;
  int firing_columns_ = 1;
  std::vector<int> row_turns_;  // by row: columns from a beam to the next; empty: 1
  bool wraps_ = false;
  bool scattered_ = false, misnumbered_ = false;
  double crowded_ = 0;
  double row_step_ = 0, column_step_ = 0;
  int hits_ = 0;
  std::vector<std::int32_t> place_;    // by cell: index of its point, -1: none; empty: the same
  std::vector<std::int32_t> next_;     // by point: index of the next one in its cell; -1: none
  std::vector<double> row_elevation_;  // rebuilt: of each row
  std::vector<double> row_azimuth_;    // rebuilt: of each row's column 0
};

}  // namespace rgbdt
