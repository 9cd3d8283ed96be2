#include "calib/odometry/internal/moving_sweep.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "calib/model/errors.h"
#include "calib/model/text.h"

namespace rgbdt::odometry {
namespace {

// The number of a narrow interval of elevations: of a ring, where rings are not narrower.
std::uint32_t ElevationOf(const Eigen::Vector3f& point) {
  constexpr float kPerUnit = 64;  // 0.9 degrees
  return static_cast<std::uint32_t>((point.z() / point.norm() + 2) * kPerUnit);
}

// Bits that look drawn: the finaliser of splitmix64 (Steele, Lea and Flood, 2014).
std::uint64_t Mix(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

// Each point with a chance that grows with its range squared, as points lie the thinner: about
// `most` of them, spread evenly over what is seen. By cells of space instead, points would be taken
// for the noise that put them across a cell's border, and the way would drift with it.
std::vector<TimedPoint> Select(const std::vector<TimedPoint>& points, std::uint64_t seed,
                               std::size_t most) {
  std::vector<float> squared;
  squared.reserve(points.size());
  for (const TimedPoint& p : points) squared.push_back(p.point.squaredNorm());
  const auto expected = [&squared](double per_squared) {
    double sum = 0;
    for (const float s : squared) sum += std::min(1.0, per_squared * s);
    return sum;
  };
  double low = 0, high = 10;  // [1/m^2]
  for (int i = 0; i < 20; ++i) {
    const double middle = i < 10 ? std::sqrt(std::max(low, 1e-6) * high) : 0.5 * (low + high);
    (expected(middle) < static_cast<double>(most) ? low : high) = middle;
  }
  std::vector<TimedPoint> selected;
  selected.reserve(most + most / 4);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double drawn = static_cast<double>(Mix(seed + i) >> 11) * 0x1p-53;
    if (drawn < low * squared[i]) selected.push_back(points[i]);
  }
  return selected;
}

// In floating point: differences of integers from outside may not be integers.
double AfterSweep(const Cloud& part, Utime utime) {
  return (static_cast<double>(utime) - static_cast<double>(part.sweep_utime)) / 1e6;
}

std::string SecondsText(double seconds) { return Format("%.3g s", seconds); }

}  // namespace

void CheckTimes(const Cloud& part) {
  if (part.utime.empty()) return;
  if (part.utime.size() != part.size()) {
    throw InputError("the sweep has " + std::to_string(part.size()) + " points and " +
                     std::to_string(part.utime.size()) + " times; expected a time for each point");
  }
  for (const Utime utime : part.utime) {
    if (std::abs(AfterSweep(part, utime)) <= Odometry::kMostStop) continue;
    throw InputError("a point of sweep " + std::to_string(part.sweep_utime) + " is of the time " +
                     std::to_string(utime) + "; expected one within " +
                     SecondsText(Odometry::kMostStop) + " of the sweep");
  }
}

void CheckMessageTimes(const Cloud& part) {
  CheckTimes(part);
  if (part.utime.empty()) return;
  constexpr double kStretch = Odometry::kMostSweep / 2;  // two without a point: a gap
  std::vector<bool> any(static_cast<std::size_t>(2 * Odometry::kMostStop / kStretch) + 2, false);
  for (const Utime utime : part.utime) {
    any[static_cast<std::size_t>((AfterSweep(part, utime) + Odometry::kMostStop) / kStretch)] =
        true;
  }
  const auto first = std::find(any.begin(), any.end(), true);
  const auto end = std::find(any.rbegin(), any.rend(), true).base();
  const auto gap = std::search_n(first, end, 2, false);
  if (gap == end) return;
  throw InputError("the points of a message of sweep " + std::to_string(part.sweep_utime) +
                   " lie apart in time by more than " + SecondsText(kStretch) +
                   "; expected those that follow one another");
}

TimedSweep TimeSweep(const Cloud& cloud, const OdometryOptions& options) {
  CheckTimes(cloud);
  TimedSweep sweep;
  std::vector<std::size_t> hits;
  hits.reserve(cloud.size());
  Utime first = cloud.sweep_utime, last = cloud.sweep_utime;
  const auto least = static_cast<float>(options.min_range_m * options.min_range_m);
  const auto most = static_cast<float>(options.max_range_m * options.max_range_m);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const float squared = cloud.points[i].squaredNorm();
    if (!(squared >= least && squared <= most)) continue;  // nor NaN
    if (!cloud.utime.empty()) {
      first = hits.empty() ? cloud.utime[i] : std::min(first, cloud.utime[i]);
      last = hits.empty() ? cloud.utime[i] : std::max(last, cloud.utime[i]);
    }
    hits.push_back(i);
  }
  const double lasts = ToSeconds(last - first);
  if (!(lasts <= Odometry::kMostStop)) {
    throw InputError("the sweep lasts " + SecondsText(lasts) + "; expected up to " +
                     SecondsText(Odometry::kMostStop));
  }
  sweep.standing = lasts > Odometry::kMostSweep;
  sweep.seconds = sweep.standing ? 0 : lasts;
  sweep.first = first;
  sweep.middle = first + (last - first) / 2;
  sweep.last = last;
  sweep.points.reserve(hits.size());
  for (const std::size_t i : hits) {
    const bool moves = !sweep.standing && !cloud.utime.empty();
    const Utime after = moves ? cloud.utime[i] - sweep.middle : 0;
    sweep.points.push_back(
        {cloud.points[i], static_cast<float>(ToSeconds(after)), ElevationOf(cloud.points[i])});
  }
  sweep.selected =
      Select(sweep.points, Mix(static_cast<std::uint64_t>(sweep.middle)), options.selected);
  return sweep;
}

SweepMotion::SweepMotion(const Rigid3& world_from_middle, const Vector6d& velocity, double seconds)
    : half_(0.5 * seconds),
      per_second_(seconds > 0 ? (kPlaces - 1) / seconds : 0),
      turn_(velocity.head<3>()),
      speed_(velocity.tail<3>()),
      rotation_(world_from_middle.rotation.toRotationMatrix()),
      translation_(world_from_middle.translation) {
  for (std::size_t k = 0; k < kPlaces; ++k) {
    times_[k] = seconds * (static_cast<double>(k) / (kPlaces - 1) - 0.5);
    const Rigid3 step = Exp(Vector6d(times_[k] * velocity));
    steps_[k] = {step.rotation.toRotationMatrix(), step.translation};
  }
}

std::vector<MapPoint> InWorld(const TimedSweep& sweep, const SweepMotion& motion) {
  std::vector<MapPoint> points;
  points.reserve(sweep.points.size());
  for (const TimedPoint& p : sweep.points) {
    points.push_back({motion.InWorld(motion.InMiddle(p)), p.elevation});
  }
  return points;
}

}  // namespace rgbdt::odometry
