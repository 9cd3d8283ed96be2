#include "calib/methods/bearing_angle/board_corners.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core/mat.hpp>

#include "calib/methods/bearing_angle/bearing_angle_image.h"
#include "calib/model/check.h"

namespace rgbdt {
namespace {

// The two images of a cloud, and what an edge is in them.
class Edges {
 public:
  Edges(const RangeGrid& grid, double edge_rad)
      : grid_(grid),
        edge_rad_(static_cast<float>(edge_rad)),
        by_columns_(BearingAngles(grid, Trace::kColumns)),
        by_rows_(BearingAngles(grid, Trace::kRows)) {}

  /// Whether a hit stands before one of its four neighbours, or beside a beam without a return.
  bool StandsBefore(int row, int column) const {
    return BeforeThePrevious(by_columns_, row, column, row, column - 1) ||
           BeforeThePrevious(by_rows_, row, column, row - 1, column) ||
           BeforeTheNext(by_columns_, row, column + 1) || BeforeTheNext(by_rows_, row + 1, column);
  }

 private:
  bool IsMiss(int row, int column) const {
    if (!grid_.Contains(row, column)) return true;
    const std::size_t cell = grid_.Cell(row, column);
    return grid_.WasFired(cell) && !grid_.IsHit(cell);
  }
  // Seen from the point before, which lies behind: 180 degrees.
  bool BeforeThePrevious(const cv::Mat& angles, int row, int column, int row_before,
                         int column_before) const {
    return IsMiss(row_before, column_before) ||
           angles.at<float>(row, column) > static_cast<float>(M_PI) - edge_rad_;
  }
  // The next point's angle tells: it lies behind, 0 degrees.
  bool BeforeTheNext(const cv::Mat& angles, int row, int column) const {
    if (IsMiss(row, column)) return true;
    return angles.at<float>(row, column % angles.cols) < edge_rad_;
  }

  const RangeGrid& grid_;
  float edge_rad_;
  cv::Mat by_columns_, by_rows_;
};

}  // namespace

void BoardCornerOptions::Check() const {
  const OptionCheck check("board corners");
  check.Positive(range_sigma_m, "range_sigma_m");
  check.Between(edge_rad, 0, M_PI / 2, "edge_rad");
  check.Positive(most_spacings, "most_spacings");
}

std::vector<Eigen::Vector3d> BoardEdges(const RangeGrid& grid, const CloudEdges& board,
                                        const Target& target, const BoardCornerOptions& options) {
  options.Check();
  const Edges edges(grid, options.edge_rad);
  const double off_plane_m = std::max(0.03, 4 * options.range_sigma_m);
  const Rigid3 target_from_lidar = board.pose->sensor_from_target.Inverse();
  const Eigen::Vector3f centre = board.centre.cast<float>();
  const auto reach = static_cast<float>(std::hypot(target.width_m, target.height_m));
  std::vector<Eigen::Vector3d> found;
  for (int row = 0; row < grid.rows(); ++row) {
    for (int column = 0; column < grid.columns(); ++column) {
      const std::size_t cell = grid.Cell(row, column);
      if (!grid.IsHit(cell) || (grid.Point(cell) - centre).squaredNorm() > reach * reach) continue;
      const Eigen::Vector3d point = grid.Point(cell).cast<double>();
      const Eigen::Vector3d on = target_from_lidar * point;
      if (std::abs(on.z()) > off_plane_m ||
          std::abs(on.x()) > target.width_m / 2 + board.spacing_m ||
          std::abs(on.y()) > target.height_m / 2 + board.spacing_m ||
          !edges.StandsBefore(row, column)) {
        continue;
      }
      found.push_back(point);
    }
  }
  return found;
}

std::vector<Eigen::Vector3d> PickBoardCorners(const RangeGrid& grid, const CloudEdges& board,
                                              const Target& target,
                                              const BoardCornerOptions& options) {
  const std::vector<Eigen::Vector3d> edges = BoardEdges(grid, board, target, options);
  const Rigid3& lidar_from_target = board.pose->sensor_from_target;
  const Rigid3 target_from_lidar = lidar_from_target.Inverse();
  const double reach_m = options.most_spacings * board.spacing_m;
  std::vector<Eigen::Vector3d> corners;
  corners.reserve(4);
  for (const Eigen::Vector3d& corner : target.OutlineCorners()) {
    const Eigen::Vector2d outward(corner.x() > 0 ? 1 : -1, corner.y() > 0 ? 1 : -1);
    Eigen::Vector3d picked = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    double farthest = -1e9;
    for (const Eigen::Vector3d& point : edges) {
      const double along = outward.dot((target_from_lidar * point).head<2>());
      if ((point - lidar_from_target * corner).norm() > reach_m || along <= farthest) continue;
      farthest = along;
      picked = point;
    }
    corners.push_back(picked);
  }
  return corners;
}

}  // namespace rgbdt
