#include "calib/sync/internal/sweep_motion.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace rgbdt::sync {
namespace {

constexpr std::size_t kLeastPoints = 30;
/// Beams are on the board for less than this before and after its middle [s]; what is farther is on
/// the other side of the sweep's seam, where the motion is not straight any more.
constexpr double kMostHalf = 0.03;

// When the beams were on the board's middle [s]; nothing: they were not.
std::optional<double> WhenOnBoard(const WavedSweep& sweep, const Target& target,
                                  const Trajectory& way) {
  if (sweep.points.empty()) return std::nullopt;
  double when = 0.5 * ToSeconds(sweep.utime.front() + sweep.utime.back() - 2 * way.start);
  // At first the board is where it was in the sweep's middle.
  for (const double margin : {-0.3, -0.1}) {
    const Rigid3 pose = way.At(when);
    std::vector<double> times;
    for (std::size_t i = 0; i < sweep.points.size(); ++i) {
      const auto met = MeetBoard(pose, sweep.points[i].cast<double>().normalized());
      if (met && IsOn(target, met->place, margin)) {
        times.push_back(ToSeconds(sweep.utime[i] - way.start));
      }
    }
    if (times.size() < kLeastPoints) return std::nullopt;
    when = Median(std::move(times));
  }
  return when;
}

}  // namespace

std::vector<WavedSweep> AboutBoard(const std::vector<WavedSweep>& sweeps, const Target& target,
                                   const Trajectory& way) {
  const double radius = 0.5 * std::hypot(target.width_m, target.height_m) + 0.5;
  std::vector<WavedSweep> about;
  for (const WavedSweep& sweep : sweeps) {
    if (sweep.points.empty() || sweep.utime.front() < way.start ||
        ToSeconds(sweep.utime.back() - way.start) > way.Length()) {
      continue;
    }
    const Utime middle = (sweep.utime.front() + sweep.utime.back()) / 2;
    const Eigen::Vector3d centre = way.At(ToSeconds(middle - way.start)).translation;
    const double least = std::cos(std::atan2(radius, centre.norm()));
    const Eigen::Vector3f towards = centre.normalized().cast<float>();
    WavedSweep some;
    for (std::size_t i = 0; i < sweep.points.size(); ++i) {
      if (sweep.points[i].dot(towards) < least * sweep.points[i].norm()) continue;
      some.points.push_back(sweep.points[i]);
      some.utime.push_back(sweep.utime[i]);
    }
    about.push_back(std::move(some));
  }
  return about;
}

std::optional<MetBoard> MeetBoard(const Rigid3& lidar_from_target, const Eigen::Vector3d& beam) {
  const Eigen::Vector3d normal = lidar_from_target.rotation * Eigen::Vector3d::UnitZ();
  const double towards = normal.dot(beam);
  // Grazing beams tell little, and are off by the beam's width.
  if (std::abs(towards) < 0.1) return std::nullopt;
  const double range = normal.dot(lidar_from_target.translation) / towards;
  if (range <= 0) return std::nullopt;
  const Eigen::Vector3d place =
      lidar_from_target.rotation.conjugate() * (range * beam - lidar_from_target.translation);
  return MetBoard{range, place.head<2>()};
}

std::optional<SweepMotion> LineariseSweep(const WavedSweep& sweep, const Target& target,
                                          const Trajectory& way, double range_offset_m,
                                          const OnBoard& options) {
  const std::optional<double> when = WhenOnBoard(sweep, target, way);
  if (!when) return std::nullopt;
  SweepMotion motion;
  motion.seconds = *when;
  motion.lidar_from_target = way.At(*when);
  motion.twist = way.TwistAt(*when);
  QuadraticSum sum;
  std::size_t used = 0;
  for (std::size_t i = 0; i < sweep.points.size(); ++i) {
    const double later = ToSeconds(sweep.utime[i] - way.start) - *when;
    if (std::abs(later) > kMostHalf) continue;
    const Eigen::Vector3d point = sweep.points[i].cast<double>();
    const double range = point.norm();
    const Eigen::Vector3d beam = point / range;
    const auto rough = MeetBoard(motion.lidar_from_target, beam);
    if (!rough || !IsOn(target, rough->place, -0.2)) continue;
    const Rigid3 pose = way.At(*when + later);
    const auto met = MeetBoard(pose, beam);
    if (!met || !IsOn(target, met->place, options.margin_m)) continue;
    const double off = range - range_offset_m - met->range;
    if (std::abs(off) > options.gate_m) continue;
    const Eigen::Vector3d normal = pose.rotation * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d meets = met->range * beam;
    const double scale = 1 / (normal.dot(beam) * options.sigma_m);
    Vector6d slope;  // of `off` by a motion of the board
    slope << normal.cross(meets), -normal;
    slope *= scale;
    Quadratic::Vector row;
    row << slope, later * slope, -1 / options.sigma_m;
    // Huber's weight: a hand before the board counts little.
    const double residual = off / options.sigma_m;
    const double weight = std::min(1.0, 3 / std::max(1e-9, std::abs(residual)));
    sum.Add(row, residual, weight);
    motion.square += weight * residual * residual;
    ++used;
  }
  if (used < kLeastPoints) return std::nullopt;
  motion.quadratic = sum.Root();
  return motion;
}

}  // namespace rgbdt::sync
