#include "calib/detect/image/internal/corner_order.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "calib/camera/target_pose.h"
#include "calib/model/view_detection.h"

namespace rgbdt {
namespace {

using Pixels = std::vector<Eigen::Vector2d>;

// The square whose top left inner corner is (column, row).
std::array<Eigen::Vector2d, 4> SquareAt(const Pixels& corners, int columns, int column, int row) {
  const auto at = [&](int c, int r) { return corners[static_cast<std::size_t>(r * columns + c)]; };
  return {at(column, row), at(column + 1, row), at(column + 1, row + 1), at(column, row + 1)};
}

// Mean over the middle fifth to fourth of a square, where blur does not reach; NaN outside and
// where one of its corners was not seen.
double Brightness(const cv::Mat& grey, const std::array<Eigen::Vector2d, 4>& square) {
  constexpr int kSteps = 3;
  const bool seen = std::all_of(square.begin(), square.end(), IsSeen);
  if (!seen) return std::numeric_limits<double>::quiet_NaN();
  double sum = 0;
  int count = 0;
  for (int i = -kSteps; i <= kSteps; ++i) {
    for (int j = -kSteps; j <= kSteps; ++j) {
      const double a = 0.5 + 0.25 * i / kSteps;
      const double b = 0.5 + 0.25 * j / kSteps;
      const Eigen::Vector2d p = (1 - b) * ((1 - a) * square[0] + a * square[1]) +
                                b * ((1 - a) * square[3] + a * square[2]);
      const auto x = static_cast<int>(std::lround(p.x()));
      const auto y = static_cast<int>(std::lround(p.y()));
      if (x < 0 || y < 0 || x >= grey.cols || y >= grey.rows) continue;
      sum += static_cast<double>(grey.at<float>(y, x));
      ++count;
    }
  }
  return sum / count;
}

}  // namespace

std::optional<bool> TopLeftIsDark(const cv::Mat& grey, const Target& target,
                                  const Pixels& corners) {
  const int nx = target.corners_x() - 1;  // squares between the corners
  const int ny = target.corners_y() - 1;
  cv::Mat brightness(ny, nx, CV_64F);
  for (int row = 0; row < ny; ++row) {
    for (int column = 0; column < nx; ++column) {
      brightness.at<double>(row, column) =
          Brightness(grey, SquareAt(corners, target.corners_x(), column, row));
    }
  }
  int dark_first = 0;  // votes of pairs of neighbours
  int light_first = 0;
  const auto vote = [&](int row, int column, int next_row, int next_column) {
    const double difference =
        brightness.at<double>(row, column) - brightness.at<double>(next_row, next_column);
    // Even squares look like the first one, which looks like the target's top left one.
    const bool even_is_darker = (row + column) % 2 == 0 ? difference < 0 : difference > 0;
    if (difference != 0 && std::isfinite(difference)) ++(even_is_darker ? dark_first : light_first);
  };
  for (int row = 0; row < ny; ++row) {
    for (int column = 0; column < nx; ++column) {
      if (column + 1 < nx) vote(row, column, row, column + 1);
      if (row + 1 < ny) vote(row, column, row + 1, column);
    }
  }
  const int needed = (4 * (dark_first + light_first) + 4) / 5;
  if (dark_first + light_first == 0 || std::max(dark_first, light_first) < needed) {
    return std::nullopt;
  }
  return dark_first > light_first;
}

bool OrderCorners(const cv::Mat& grey, const Target& target, bool black_is_dark, Pixels* corners) {
  if (!RightHanded(target, *corners)) {
    for (auto row = corners->begin(); row != corners->end(); row += target.corners_x()) {
      std::reverse(row, row + target.corners_x());
    }
  }
  const bool pattern_tells = (target.squares_x + target.squares_y) % 2 == 1;
  if (!pattern_tells || !black_is_dark) return false;
  const auto dark = TopLeftIsDark(grey, target, *corners);
  if (!dark) return false;
  if (!*dark) std::reverse(corners->begin(), corners->end());
  return true;
}

}  // namespace rgbdt
