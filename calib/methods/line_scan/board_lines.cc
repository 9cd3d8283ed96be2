#include "calib/methods/line_scan/board_lines.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace rgbdt {
namespace {

int LineOf(const Cloud& cloud, std::size_t i) {
  if (!cloud.ring.empty()) return cloud.ring[i];
  return static_cast<int>(i) / std::max(1, cloud.beams);
}

}  // namespace

std::vector<PointGroup> LinesOnBoard(const Cloud& cloud, const CloudEdges& board,
                                     const Target& target, double range_sigma_m) {
  constexpr double kRimM = 0.04;
  const double off_plane_m = std::max(0.03, 4 * range_sigma_m);
  const Rigid3 target_from_lidar = board.pose->sensor_from_target.Inverse();
  const auto reach = static_cast<float>(std::hypot(target.width_m, target.height_m));
  const Eigen::Vector3f centre = board.centre.cast<float>();
  std::map<int, PointGroup> lines;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud.IsHit(i) || (cloud.points[i] - centre).squaredNorm() > reach * reach) continue;
    const Eigen::Vector3d p = cloud.points[i].cast<double>();
    const Eigen::Vector3d on = target_from_lidar * p;
    if (std::abs(on.z()) > off_plane_m || std::abs(on.x()) > target.width_m / 2 - kRimM ||
        std::abs(on.y()) > target.height_m / 2 - kRimM) {
      continue;
    }
    Eigen::Vector4d q(0, 0, 0, 1);
    q.head<3>() = p - board.centre;
    PointGroup& line = lines[LineOf(cloud, i)];
    line.ring = LineOf(cloud, i);
    line.scatter += q * q.transpose();
  }
  std::vector<PointGroup> groups;
  groups.reserve(lines.size());
  for (const auto& [number, line] : lines) groups.push_back(line);
  return groups;
}

}  // namespace rgbdt
