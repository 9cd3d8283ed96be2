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

namespace {

struct Hits {
  std::vector<std::size_t> places;
  Utime first = 0, last = 0;
  double seconds() const { return ToSeconds(last - first); }
};

// What returned from where it is of use.
Hits HitsOf(const Cloud& cloud, const OdometryOptions& options) {
  CheckTimes(cloud);
  Hits hits;
  hits.places.reserve(cloud.size());
  hits.first = hits.last = cloud.sweep_utime;
  const auto least = static_cast<float>(options.min_range_m * options.min_range_m);
  const auto most = static_cast<float>(options.max_range_m * options.max_range_m);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const float squared = cloud.points[i].squaredNorm();
    if (!(squared >= least && squared <= most)) continue;  // nor NaN
    if (!cloud.utime.empty()) {
      hits.first = hits.places.empty() ? cloud.utime[i] : std::min(hits.first, cloud.utime[i]);
      hits.last = hits.places.empty() ? cloud.utime[i] : std::max(hits.last, cloud.utime[i]);
    }
    hits.places.push_back(i);
  }
  if (!(hits.seconds() <= Odometry::kMostStop)) {
    throw InputError("the sweep lasts " + SecondsText(hits.seconds()) + "; expected up to " +
                     SecondsText(Odometry::kMostStop));
  }
  return hits;
}

}  // namespace

TimedSweep TimeSweep(const Cloud& cloud, const OdometryOptions& options) {
  const Hits hits = HitsOf(cloud, options);
  TimedSweep sweep;
  sweep.turned = hits.seconds() > Odometry::kMostSweep;
  sweep.seconds = sweep.turned ? 0 : hits.seconds();
  sweep.first = hits.first;
  sweep.middle = hits.first + (hits.last - hits.first) / 2;
  sweep.last = hits.last;
  sweep.points.reserve(hits.places.size());
  for (const std::size_t i : hits.places) {
    const bool moves = !sweep.turned && !cloud.utime.empty();
    const Utime after = moves ? cloud.utime[i] - sweep.middle : 0;
    sweep.points.push_back(
        {cloud.points[i], static_cast<float>(ToSeconds(after)), ElevationOf(cloud.points[i])});
  }
  sweep.selected =
      Select(sweep.points, Mix(static_cast<std::uint64_t>(sweep.middle)), options.selected);
  return sweep;
}

std::vector<TimedSweep> PartsOf(const Cloud& cloud, const OdometryOptions& options) {
  constexpr double kPart = 0.1;           // [s]
  constexpr std::size_t kSelected = 120;  // of a part, about
  const Hits hits = HitsOf(cloud, options);
  const auto count = static_cast<std::size_t>(std::max(1.0, std::ceil(hits.seconds() / kPart)));
  const double lasts = hits.seconds() / static_cast<double>(count);
  std::vector<TimedSweep> parts(count);
  const auto begin = [&](std::size_t k) {
    return hits.first + FromSeconds(lasts * static_cast<double>(k));
  };
  for (std::size_t k = 0; k < count; ++k) {
    parts[k].first = begin(k);
    parts[k].last = begin(k + 1);
    parts[k].middle = parts[k].first + (parts[k].last - parts[k].first) / 2;
    parts[k].seconds = lasts;
    parts[k].turned = true;
  }
  if (cloud.utime.empty()) return parts;
  for (const std::size_t i : hits.places) {
    const double after = ToSeconds(cloud.utime[i] - hits.first);
    const auto k = std::min(count - 1, static_cast<std::size_t>(after / std::max(lasts, 1e-9)));
    parts[k].points.push_back({cloud.points[i],
                               static_cast<float>(ToSeconds(cloud.utime[i] - parts[k].middle)),
                               ElevationOf(cloud.points[i])});
  }
  for (TimedSweep& part : parts) {
    part.selected = Select(part.points, Mix(static_cast<std::uint64_t>(part.middle)), kSelected);
  }
  return parts;
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
