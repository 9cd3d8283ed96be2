#include "calib/detect/image/contrast.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <optional>

#include "calib/model/statistics.h"

namespace rgbdt {
namespace {

// Mean of 3x3 pixels; nothing outside the image.
std::optional<double> ValueAt(const cv::Mat& grey, const Eigen::Vector2d& pixel) {
  if (!pixel.allFinite()) return std::nullopt;  // beside a corner that was not seen
  const int x = static_cast<int>(std::lround(pixel.x()));
  const int y = static_cast<int>(std::lround(pixel.y()));
  if (x < 1 || y < 1 || x > grey.cols - 2 || y > grey.rows - 2) return std::nullopt;
  return cv::mean(grey(cv::Rect(x - 1, y - 1, 3, 3)))[0];
}

}  // namespace

double SquareContrast(const cv::Mat& grey, const Target& target,
                      const std::vector<Eigen::Vector2d>& corners) {
  if (target.holes) return 0;  // a marker's middle is black or white
  const int columns = target.corners_x() - 1;
  const int rows = target.corners_y() - 1;
  const auto value = [&](int column, int row) {
    const auto corner = [&](int x, int y) {
      return corners.at(static_cast<std::size_t>(y * target.corners_x() + x));
    };
    return ValueAt(grey, 0.25 * (corner(column, row) + corner(column + 1, row) +
                                 corner(column, row + 1) + corner(column + 1, row + 1)));
  };
  // Squares of one colour minus their neighbours of the other: a slope over the board cancels.
  std::vector<double> steps;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const auto here = value(column, row);
      const double sign = (row + column) % 2 == 0 ? 1 : -1;
      for (const auto& [x, y] : {std::pair{column + 1, row}, std::pair{column, row + 1}}) {
        if (x >= columns || y >= rows) continue;
        const auto there = value(x, y);
        if (here && there) steps.push_back(sign * (*here - *there));
      }
    }
  }
  return std::abs(Median(std::move(steps)));
}

}  // namespace rgbdt
