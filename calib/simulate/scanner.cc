#include "calib/simulate/scanner.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/simulate/noise.h"

namespace rgbdt::simulate {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Places in the unit disc: the middle, and rings of 6, 12, ... of which each stands for the same
/// area. Rings are turned so that no places line up with an upright or level edge.
std::vector<Eigen::Vector2d> DiscPlaces(int rings) {
  const double count = 1 + 3 * rings * (rings + 1);
  std::vector<Eigen::Vector2d> places{{0, 0}};
  for (int ring = 1; ring <= rings; ++ring) {
    // Radius that halves the ring's area; the ring starts where 1 + 3 ring (ring - 1) shares end.
    const double radius = std::sqrt((1 + 3 * ring * (ring - 1) + 3 * ring) / count);
    for (int i = 0; i < 6 * ring; ++i) {
      const double angle = 2 * kPi * (i + 0.37 * ring) / (6 * ring);
      places.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
  }
  return places;
}

}  // namespace

BeamReturn CombineReturns(const ScannerOptions& options, int sub_rays,
                          std::vector<SubReturn>* returns) {
  std::sort(returns->begin(), returns->end(),
            [](const SubReturn& a, const SubReturn& b) { return a.range < b.range; });
  double best_energy = 0;
  double best_range = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < returns->size();) {
    double energy = 0;
    double moment = 0;
    do {
      const SubReturn& r = (*returns)[i++];
      const double e = r.reflectivity / sub_rays / (r.range * r.range);
      energy += e;
      moment += e * r.range;
    } while (i < returns->size() &&
             (*returns)[i].range - (*returns)[i - 1].range < options.merge_m);
    if (energy > best_energy) {
      best_energy = energy;
      best_range = moment / energy;
    }
  }
  BeamReturn result{best_range, best_energy * best_range * best_range};
  // NaN, where nothing came back, fails this comparison too.
  if (!(result.intensity >= options.min_return * options.white_wall_reflectivity)) {
    result = {std::numeric_limits<double>::quiet_NaN(), 0};
  }
  return result;
}

Scanner::Scanner(const ScannerOptions& options, std::uint64_t seed)
    : options_(options), seed_(seed) {
  const double tilt = options.tilt_rad.norm();
  geometry_.motor_from_scanner = tilt > 0 ? RotationAbout(options.tilt_rad / tilt, tilt) : Rigid3();
  geometry_.motor_from_scanner.translation = options.lever_arm_m;
  geometry_.ticks_per_rad = options.ticks_per_rad;
  geometry_.zero_ticks = options.zero_ticks;
  const std::vector<Eigen::Vector2d> disc = DiscPlaces(options.divergence_rings);
  sub_ray_count_ = static_cast<int>(disc.size());
  for (int beam = 0; beam < options.beams; ++beam) {
    const double a = options.first_angle_rad + options.angle_step_rad * beam;
    const Eigen::Vector3d along(std::cos(a), 0, std::sin(a));
    const Eigen::Vector3d up(-std::sin(a), 0, std::cos(a));
    for (const Eigen::Vector2d& place : disc) {
      const Eigen::Vector2d off = place * std::tan(0.5 * options.divergence_rad);
      sub_rays_.push_back(geometry_.motor_from_scanner.rotation *
                          (along + off.x() * Eigen::Vector3d::UnitY() + off.y() * up).normalized());
    }
  }
}

int Scanner::sweep_lines() const {
  const double seconds = options_.sweep_rad / options_.motor_speed_rad_s;
  return std::max(1, static_cast<int>(std::lround(seconds / ToSeconds(line_period()))));
}

Utime Scanner::line_period() const { return FromSeconds(options_.beams * options_.beam_period_s); }

double Scanner::MotorAngle(double seconds) const {
  return options_.sweep_start_rad +
         std::clamp(seconds * options_.motor_speed_rad_s, 0.0, options_.sweep_rad);
}

std::int64_t Scanner::Ticks(double motor_angle) const {
  return std::llround(motor_angle * options_.ticks_per_rad + options_.zero_ticks);
}

Eigen::Vector3d Scanner::Centre(double motor_angle) const {
  return RotationAbout(Eigen::Vector3d::UnitZ(), motor_angle) *
         geometry_.motor_from_scanner.translation;
}

BeamReturn Scanner::Beam(const World& world, int beam, double motor_angle) const {
  const double c = std::cos(motor_angle);
  const double s = std::sin(motor_angle);
  const auto turned = [&](const Eigen::Vector3d& v) {
    return Eigen::Vector3d(c * v.x() - s * v.y(), s * v.x() + c * v.y(), v.z());
  };
  const Eigen::Vector3d origin = turned(geometry_.motor_from_scanner.translation);
  thread_local std::vector<Eigen::Vector3d> directions;
  thread_local std::vector<Hit> hits;
  thread_local std::vector<SubReturn> returns;
  directions.resize(static_cast<std::size_t>(sub_ray_count_));
  hits.resize(directions.size());
  returns.clear();
  const std::size_t first = static_cast<std::size_t>(beam) * directions.size();
  for (std::size_t i = 0; i < directions.size(); ++i) directions[i] = turned(sub_rays_[first + i]);
  world.caster().CastFan(origin, directions.data(), sub_ray_count_, hits.data());
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const Hit& hit = hits[i];
    if (!hit.hit() || hit.range > options_.max_range_m) continue;
    returns.push_back({hit.range, world.Reflectivity(hit, origin + hit.range * directions[i])});
  }
  return CombineReturns(options_, sub_ray_count_, &returns);
}

LineScan Scanner::Line(const World& world, Utime sweep_utime, int line) const {
  LineScan scan;
  scan.utime = sweep_utime + line * line_period();
  scan.beam_period_s = options_.beam_period_s;
  scan.first_angle_rad = options_.first_angle_rad;
  scan.angle_step_rad = options_.angle_step_rad;
  scan.range.resize(static_cast<std::size_t>(options_.beams));
  scan.intensity.resize(scan.range.size());
  const Noise noise(seed_, scan.utime, "lidar");
  for (int beam = 0; beam < options_.beams; ++beam) {
    const double seconds = ToSeconds(scan.utime - sweep_utime) + beam * options_.beam_period_s;
    const BeamReturn back = Beam(world, beam, MotorAngle(seconds));
    const auto i = static_cast<std::size_t>(beam);
    scan.range[i] = static_cast<float>(back.range + options_.range_sigma_m * noise.Normal(2 * i));
    scan.intensity[i] =
        std::isnan(back.range)
            ? 0.0F
            : static_cast<float>(std::clamp(
                  back.intensity + options_.intensity_sigma * noise.Normal(2 * i + 1), 0.0, 1.0));
  }
  return scan;
}

}  // namespace rgbdt::simulate
