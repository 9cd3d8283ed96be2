#include "calib/odometry/internal/place.h"

#include <algorithm>
#include <cmath>

namespace rgbdt::odometry {
namespace {

constexpr std::size_t kFewestPoints = 100;
constexpr double kGroundShare = 0.05;  // of the points lie lower than the ground's height
constexpr double kGroundReach = 20;    // [m] within which the ground is looked for
constexpr float kLeastHeight = 0.3F;   // [m] what is lower is ground
constexpr float kMostHeight = 8;       // [m] higher things hide each other
constexpr int kFewestSectors = 20;     // in which both places have something

double GroundOf(const std::vector<Eigen::Vector3d>& points) {
  std::vector<double> heights;
  for (const Eigen::Vector3d& p : points) {
    if (p.head<2>().norm() < kGroundReach) heights.push_back(p.z());
  }
  if (heights.empty()) return 0;
  const auto lowest = heights.begin() + static_cast<std::ptrdiff_t>(
                                            kGroundShare * static_cast<double>(heights.size()));
  std::nth_element(heights.begin(), lowest, heights.end());
  return *lowest;
}

// Mean over the sectors of 1 - cosine between their columns, b's turned by `shift` sectors. A
// sector that is empty in one of them alone counts as unlike.
double UnlikenessAt(const Place& a, const Place& b, int shift,
                    const Eigen::Matrix<float, 1, Place::kSectors>& norm_a,
                    const Eigen::Matrix<float, 1, Place::kSectors>& norm_b) {
  double sum = 0;
  int either = 0, both = 0;
  for (int i = 0; i < Place::kSectors; ++i) {
    const int k = (i + Place::kSectors - shift) % Place::kSectors;
    if (norm_a[i] == 0 && norm_b[k] == 0) continue;
    ++either;
    if (norm_a[i] == 0 || norm_b[k] == 0) {
      sum += 1;
      continue;
    }
    ++both;
    sum += 1 - a.heights.col(i).dot(b.heights.col(k)) / (norm_a[i] * norm_b[k]);
  }
  return both < kFewestSectors ? 1 : sum / either;
}

}  // namespace

std::optional<Place> PlaceOf(const std::vector<Eigen::Vector3d>& points) {
  if (points.size() < kFewestPoints) return std::nullopt;
  const double ground = GroundOf(points);
  Place place;
  place.heights.setZero();
  for (const Eigen::Vector3d& p : points) {
    const double distance = p.head<2>().norm();
    const auto height = std::min(kMostHeight, static_cast<float>(p.z() - ground));
    if (distance >= Place::kReach || height < kLeastHeight) continue;
    const int ring = static_cast<int>(distance / Place::kReach * Place::kRings);
    const double share = std::atan2(p.y(), p.x()) / (2 * M_PI) + 0.5;
    const int sector = std::min(Place::kSectors - 1, static_cast<int>(share * Place::kSectors));
    float& cell = place.heights(ring, sector);
    cell = std::max(cell, height);
  }
  place.mean = place.heights.rowwise().mean();
  return place;
}

Unlikeness Compare(const Place& a, const Place& b) {
  const Eigen::Matrix<float, 1, Place::kSectors> norm_a = a.heights.colwise().norm();
  const Eigen::Matrix<float, 1, Place::kSectors> norm_b = b.heights.colwise().norm();
  Unlikeness best;
  for (int shift = 0; shift < Place::kSectors; ++shift) {
    const double value = UnlikenessAt(a, b, shift, norm_a, norm_b);
    if (value >= best.value) continue;
    const double turn = 2 * M_PI * shift / Place::kSectors;
    best = {value, turn > M_PI ? turn - 2 * M_PI : turn};
  }
  return best;
}

}  // namespace rgbdt::odometry
