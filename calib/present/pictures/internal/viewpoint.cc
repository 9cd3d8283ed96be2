#include "calib/present/pictures/internal/viewpoint.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "calib/model/statistics.h"

namespace rgbdt {
namespace {

Viewpoint LookAt(const Eigen::Vector3d& eye, const Eigen::Vector3d& target,
                 const DrawOptions& options) {
  const Eigen::Vector3d forward = (target - eye).normalized();
  Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ());
  if (right.norm() < 1e-6) right = -Eigen::Vector3d::UnitY();  // straight down or up
  right.normalize();
  Viewpoint viewpoint;
  viewpoint.view_from_lidar << right.transpose(), forward.cross(right).transpose(),
      forward.transpose();
  viewpoint.eye = eye;
  const int width = options.width * kSupersampling, height = options.height * kSupersampling;
  viewpoint.focal = 0.5 * width / std::tan(0.5 * options.field_of_view_deg * M_PI / 180);
  viewpoint.cx = 0.5 * (width - 1);
  viewpoint.cy = 0.5 * (height - 1);
  return viewpoint;
}

// The points that matter for framing: those that a camera saw, or all where hardly any.
std::vector<Eigen::Vector3d> Subject(const RgbdtCloud& cloud) {
  std::vector<Eigen::Vector3d> seen_points, all;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud.points[i].allFinite()) continue;
    all.emplace_back(cloud.points[i].cast<double>());
    const bool seen = cloud.rgb[i] != std::array<std::uint8_t, 3>{0, 0, 0} ||
                      std::isfinite(cloud.thermal_counts[i]) ||
                      std::isfinite(cloud.temperature_k[i]);
    if (seen) seen_points.push_back(all.back());
  }
  return seen_points.size() >= 50 ? seen_points : all;
}

double Percentile(std::vector<double> values, double fraction) {
  const auto k = static_cast<std::size_t>(fraction * static_cast<double>(values.size() - 1));
  return Nth(std::move(values), k);
}

Eigen::Vector3d Middle(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d middle;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    values.reserve(points.size());
    for (const Eigen::Vector3d& point : points) values.push_back(point[axis]);
    middle[axis] = Percentile(values, 0.5);
  }
  return middle;
}

// The nearer part: what people look at stands in front of the walls.
std::vector<Eigen::Vector3d> NearerPart(std::vector<Eigen::Vector3d> points) {
  const auto end = points.begin() + static_cast<std::ptrdiff_t>((points.size() + 1) * 6 / 10);
  std::nth_element(points.begin(), end == points.end() ? points.begin() : end, points.end(),
                   [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
                     return a.squaredNorm() < b.squaredNorm();
                   });
  points.erase(end, points.end());
  return points;
}

// Turns nothing, but zooms and shifts so that nearly all of `points` fills the picture.
void Fit(const std::vector<Eigen::Vector3d>& points, Viewpoint* viewpoint) {
  std::vector<double> xs, ys;
  for (const Eigen::Vector3d& point : points) {
    const Eigen::Vector3d p = *viewpoint * point;
    if (p.z() < 0.1) continue;
    xs.push_back(p.x() / p.z());
    ys.push_back(p.y() / p.z());
  }
  if (xs.size() < 10) return;
  const double left = Percentile(xs, 0.02), right = Percentile(xs, 0.98);
  const double top = Percentile(ys, 0.02), bottom = Percentile(ys, 0.98);
  const double width = 2 * viewpoint->cx + 1, height = 2 * viewpoint->cy + 1;
  const double zoom =
      0.88 * std::min(width / std::max(right - left, 1e-3), height / std::max(bottom - top, 1e-3));
  viewpoint->focal = std::min(zoom, 4 * viewpoint->focal);
  viewpoint->cx -= viewpoint->focal * 0.5 * (left + right);
  viewpoint->cy -= viewpoint->focal * 0.5 * (top + bottom);
}

}  // namespace

Viewpoint ChooseViewpoint(const RgbdtCloud& cloud, const DrawOptions& options) {
  const std::vector<Eigen::Vector3d> subject = Subject(cloud);
  const Eigen::Vector3d target =
      options.look_at ? *options.look_at
                      : (subject.empty() ? Eigen::Vector3d(1, 0, 0) : Middle(NearerPart(subject)));
  if (options.eye) return LookAt(*options.eye, target, options);
  Eigen::Vector3d ahead(target.x(), target.y(), 0);
  ahead = ahead.norm() > 1e-3 ? ahead.normalized() : Eigen::Vector3d::UnitX();
  const Eigen::Vector3d left = Eigen::Vector3d::UnitZ().cross(ahead);
  const double distance = std::max(0.5, target.norm());
  const Eigen::Vector3d eye =
      distance * (-0.25 * ahead + 0.3 * left + 0.25 * Eigen::Vector3d::UnitZ());
  Viewpoint viewpoint = LookAt(eye, target, options);
  if (!options.look_at) Fit(subject, &viewpoint);
  return viewpoint;
}

}  // namespace rgbdt
