#include "calib/methods/bearing_angle/bearing_angle_image.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rgbdt {
namespace {

float AngleAt(const RangeGrid& grid, std::size_t cell, std::size_t before) {
  const Eigen::Vector3d point = grid.Point(cell).cast<double>();
  const Eigen::Vector3d step = point - grid.Point(before).cast<double>();
  const Eigen::Vector3d beam = point - grid.Origin(cell);
  const double cosine = beam.dot(step) / (beam.norm() * step.norm());
  return static_cast<float>(std::acos(std::clamp(cosine, -1.0, 1.0)));
}

}  // namespace

cv::Mat BearingAngles(const RangeGrid& grid, Trace trace) {
  cv::Mat image(grid.rows(), grid.columns(), CV_32FC1,
                cv::Scalar(std::numeric_limits<float>::quiet_NaN()));
  for (int row = 0; row < grid.rows(); ++row) {
    for (int column = 0; column < grid.columns(); ++column) {
      const int row_before = trace == Trace::kRows ? row - 1 : row;
      const int column_before = trace == Trace::kColumns ? column - 1 : column;
      if (!grid.Contains(row_before, column_before)) continue;
      const std::size_t cell = grid.Cell(row, column);
      const std::size_t before = grid.Cell(row_before, column_before);
      if (!grid.IsHit(cell) || !grid.IsHit(before)) continue;
      image.at<float>(row, column) = AngleAt(grid, cell, before);
    }
  }
  return image;
}

}  // namespace rgbdt
