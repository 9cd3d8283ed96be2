#include "calib/odometry/internal/plane_residuals.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rgbdt::odometry {
namespace {

constexpr double kOnPlane = 0.1;       // [m]
constexpr double kLeastScale = 0.003;  // [m] of distances
// A beam as wide as most that grazes a plane comes back from its near end: [rad]
constexpr double kGrazing = 0.05;

}  // namespace

void PlaneResiduals::Add(std::size_t part, const TimedSweep& sweep, const SweepMotion& motion,
                         bool match, std::vector<Match>* matches) {
  matches->resize(sweep.selected.size());
  for (std::size_t i = 0; i < sweep.selected.size(); ++i) {
    const TimedPoint& p = sweep.selected[i];
    Match& own = (*matches)[i];
    const Eigen::Vector3d in_middle = motion.InMiddle(p);
    const Eigen::Vector3d in_world = motion.InWorld(in_middle);
    if (match) own = map_.Find(in_world);
    if (own.plane == nullptr) continue;
    const Plane& plane = *own.plane;
    const Eigen::Vector3d normal = motion.rotation().transpose() * plane.normal;
    if (match && std::abs(normal.dot(in_middle)) < kGrazing * in_middle.norm()) {
      own.plane = nullptr;
      continue;
    }
    Residual r;
    r.part = part;
    r.match = own;
    r.in_middle = in_middle;
    r.seconds = p.seconds;
    r.distance = plane.normal.dot(in_world - plane.mean);
    r.slope << in_middle.cross(normal), normal;
    all_.push_back(r);
  }
}

void PlaneResiduals::Weigh(bool scale, double least_width_m) {
  near_ = 0;
  if (all_.empty()) return;
  std::vector<double> distances;
  double squared = 0;
  std::size_t on_plane = 0;
  for (const Residual& r : all_) {
    distances.push_back(std::abs(r.distance));
    squared += r.in_middle.squaredNorm();
    if (distances.back() < kOnPlane) ++on_plane;
    if (distances.back() < kNearPlane) ++near_;
  }
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  median_ = *middle;
  fit_ = static_cast<double>(on_plane) / static_cast<double>(all_.size());
  lever_ = std::sqrt(squared / static_cast<double>(all_.size()));
  if (scale) scale_ = std::max(kLeastScale, 1.4826 * median_);
  width_ = std::max(2 * scale_, least_width_m);
  std::array<std::vector<float>, PlaneMap::kLevels> counts;
  for (std::size_t level = 0; level < counts.size(); ++level) {
    counts[level].resize(map_.size(static_cast<int>(level)));
  }
  const auto count = [&](const Match& m) -> float& {
    return counts[static_cast<std::size_t>(m.level)][m.voxel];
  };
  for (const Residual& r : all_) count(r.match) += 1;
  for (Residual& r : all_) {
    r.common = count(r.match) * r.match.plane->mean_variance;
    r.weight = WeightOf(r, scale_);
  }
}

double PlaneResiduals::WeightOf(const Residual& r, double scatter) const {
  const double whitened = r.distance / width_;
  return 1 / ((scatter * scatter + r.common) * (1 + whitened * whitened));
}

}  // namespace rgbdt::odometry
