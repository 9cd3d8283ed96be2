#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calib/detect/image/internal/corner_grid.h"

namespace rgbdt {

/// A smooth map from (column, row) to the image that a flat grid follows through any ordinary lens:
/// a homography plus a polynomial of third degree for what the lens bends.
class GridModel {
 public:
  /// Fits places of a grid; those that lie off by more than `tolerance` of the distance between
  /// neighbours are left out. Nothing where fewer than 8, or less than half of them, agree.
  static std::optional<GridModel> Fit(const CornerGrid& grid, double tolerance);

  /// The same of places anywhere on the grid.
  struct Point {
    Eigen::Vector2d at{0, 0};     ///< column and row
    Eigen::Vector2d place{0, 0};  ///< [px]
  };
  static std::optional<GridModel> Fit(const std::vector<Point>& points, double tolerance);

  /// Place [px] of a column and row, fractions allowed.
  Eigen::Vector2d At(double column, double row) const;
  /// Image shift of one column (first) and one row (second) there [px].
  Eigen::Matrix2d Steps(double column, double row) const;
  /// How the grid's lines bend there: second difference over columns (first) and rows (second)
  /// [px].
  Eigen::Matrix2d Bends(double column, double row) const;
  /// Length of the shorter of the two steps [px].
  double Spacing(double column, double row) const;
  /// Whether a place lies within `tolerance` (of the distance of neighbours) of where it should.
  bool Agrees(const CornerGrid::value_type& corner, double tolerance) const;
  bool Agrees(const Point& point, double tolerance) const;

 private:
  Eigen::Vector2d centre_{0, 0};  ///< column and row
  double scale_ = 1;
  Eigen::Matrix3d homography_ = Eigen::Matrix3d::Identity();
  Eigen::Matrix<double, 10, 2> bend_ = Eigen::Matrix<double, 10, 2>::Zero();
};

}  // namespace rgbdt
