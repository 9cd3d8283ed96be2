#include "calib/present/pictures/internal/point_radius.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "calib/model/statistics.h"

namespace rgbdt {
namespace {

constexpr float kNone = std::numeric_limits<float>::infinity();
// Times the spacing of the beams: half the diagonal of a square and some more; and the most.
constexpr float kLeast = 0.8f, kMost = 3, kStep = 8;

// Angle between neighbouring beams [rad], the median over some of them.
double BeamSpacing(const std::vector<Eigen::Vector3f>& points) {
  constexpr std::size_t kSamples = 101;
  std::vector<Eigen::Vector3f> beams;
  beams.reserve(points.size());
  for (const Eigen::Vector3f& point : points) {
    if (point.allFinite() && !point.isZero(0)) beams.push_back(point.normalized());
  }
  if (beams.size() < 2) return 0.003;
  std::vector<double> spacings;
  const std::size_t step = std::max<std::size_t>(1, beams.size() / kSamples);
  for (std::size_t i = step / 2; i < beams.size(); i += step) {
    float nearest = kNone;
    for (const Eigen::Vector3f& beam : beams) {
      const float squared = (beam - beams[i]).squaredNorm();
      if (squared > 1e-9f && squared < nearest) nearest = squared;  // not itself, not its double
    }
    if (std::isfinite(nearest)) spacings.push_back(std::sqrt(nearest));
  }
  return spacings.empty() ? 0.003 : std::clamp(Median(spacings), 0.0005, 0.03);
}

/// Points by direction: azimuth and elevation in cells as large as the beams' spacing.
class Grid {
 public:
  Grid(const std::vector<Eigen::Vector3f>& points, double spacing)
      : points_(points), spacing_(spacing) {
    cells_.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (points[i].allFinite()) cells_.emplace_back(KeyOf(points[i], 0, 0), i);
    }
    std::sort(cells_.begin(), cells_.end());
  }

  /// Distance [m] to the nearest point of the cell that lies so many cells aside.
  float Nearest(std::size_t i, int columns, int rows) const {
    const std::int64_t key = KeyOf(points_[i], columns, rows);
    float nearest = kNone;
    for (auto it =
             std::lower_bound(cells_.begin(), cells_.end(), std::make_pair(key, std::size_t{0}));
         it != cells_.end() && it->first == key; ++it) {
      nearest = std::min(nearest, (points_[it->second] - points_[i]).norm());
    }
    return nearest;
  }

 private:
  std::int64_t KeyOf(const Eigen::Vector3f& point, int columns, int rows) const {
    const double azimuth = std::atan2(point.y(), point.x());
    const double elevation = std::atan2(point.z(), std::hypot(point.x(), point.y()));
    const auto column = static_cast<std::int64_t>(std::floor(azimuth / spacing_)) + columns;
    const auto row = static_cast<std::int64_t>(std::floor(elevation / spacing_)) + rows;
    return row * 1'000'000 + column;
  }

  const std::vector<Eigen::Vector3f>& points_;
  double spacing_;
  std::vector<std::pair<std::int64_t, std::size_t>> cells_;
};

// To the nearest point towards one side: straight on, or one cell beside.
float NearestTowards(const Grid& grid, std::size_t i, int column, int row) {
  float nearest = kNone;
  for (int step = 1; step <= 2; ++step) {
    for (int aside = -1; aside <= 1; ++aside) {
      nearest = std::min(nearest, grid.Nearest(i, column != 0 ? column * step : aside,
                                               row != 0 ? row * step : aside));
    }
    if (nearest < kNone) break;
  }
  return nearest;
}

}  // namespace

std::vector<float> PointRadii(const std::vector<Eigen::Vector3f>& points) {
  const double spacing = BeamSpacing(points);
  const Grid grid(points, spacing);
  std::vector<float> radii(points.size(), 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) continue;
    // Per direction the nearer side: at an edge the other one is another surface.
    const float across = std::min(NearestTowards(grid, i, 1, 0), NearestTowards(grid, i, -1, 0));
    const float along = std::min(NearestTowards(grid, i, 0, 1), NearestTowards(grid, i, 0, -1));
    const float base = static_cast<float>(spacing) * points[i].norm();
    // A gap far larger than the beams' is a step from one surface to another.
    const float gap = std::max(across, along);
    const bool surface = gap < kStep * base;
    radii[i] = surface ? std::clamp(0.6f * gap, kLeast * base, kMost * base) : kLeast * base;
  }
  return radii;
}

}  // namespace rgbdt
