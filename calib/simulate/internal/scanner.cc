#include "calib/simulate/internal/scanner.h"

#include <algorithm>
#include <cmath>

#include "calib/model/parallel.h"
#include "calib/simulate/internal/noise.h"

namespace rgbdt::simulate {
Scanner::Scanner(const ScannerOptions& options, std::uint64_t seed)
    : options_(options), seed_(seed) {
  const double tilt = options.tilt_rad.norm();
  geometry_.motor_from_scanner = tilt > 0 ? RotationAbout(options.tilt_rad / tilt, tilt) : Rigid3();
  geometry_.motor_from_scanner.translation = options.lever_arm_m;
  geometry_.ticks_per_rad = options.ticks_per_rad;
  geometry_.zero_ticks = options.zero_ticks;
  for (int beam = 0; beam < options.beams; ++beam) {
    const double elevation = options.first_angle_rad + options.angle_step_rad * beam;
    for (const Eigen::Vector3d& ray : SubRays(options, elevation)) {
      sub_rays_.push_back(geometry_.motor_from_scanner.rotation * ray);
    }
  }
  sub_ray_count_ = static_cast<int>(sub_rays_.size()) / options.beams;
}

int Scanner::sweep_lines() const {
  const double seconds = options_.sweep_rad / options_.motor_speed_rad_s;
  return std::max(1, static_cast<int>(std::lround(seconds / ToSeconds(line_period()))));
}

Utime Scanner::line_period() const { return FromSeconds(options_.beams * options_.beam_period_s); }

double Scanner::MotorAngle(double seconds) const {
  const double turned = std::clamp(seconds * options_.motor_speed_rad_s, 0.0, options_.sweep_rad);
  return options_.sweep_start_rad + (back_ ? options_.sweep_rad - turned : turned);
}

std::int64_t Scanner::Ticks(double motor_angle) const {
  return std::llround(motor_angle * options_.ticks_per_rad + options_.zero_ticks);
}

Eigen::Vector3d Scanner::Centre(double motor_angle) const {
  return RotationAbout(Eigen::Vector3d::UnitZ(), motor_angle) *
         geometry_.motor_from_scanner.translation;
}

BeamReturn Scanner::Beam(const World& world, int beam, double motor_angle,
                         const Rigid3& world_from_lidar) const {
  const double c = std::cos(motor_angle);
  const double s = std::sin(motor_angle);
  const auto turned = [&](const Eigen::Vector3d& v) {
    return Eigen::Vector3d(c * v.x() - s * v.y(), s * v.x() + c * v.y(), v.z());
  };
  const Eigen::Vector3d origin =
      world_from_lidar * turned(geometry_.motor_from_scanner.translation);
  thread_local std::vector<Eigen::Vector3d> directions;
  directions.resize(static_cast<std::size_t>(sub_ray_count_));
  const std::size_t first = static_cast<std::size_t>(beam) * directions.size();
  for (std::size_t i = 0; i < directions.size(); ++i) {
    directions[i] = world_from_lidar.rotation * turned(sub_rays_[first + i]);
  }
  BeamReturn back;
  CastBeams(world, options_, origin, directions, sub_ray_count_, &back);
  return back;
}

LineScan Scanner::Line(const World& world, Utime sweep_utime, int line, const Way& way) const {
  const Utime utime = sweep_utime + line * line_period();
  const auto motor_angle = [&](double seconds) {
    return MotorAngle(ToSeconds(utime - sweep_utime) + seconds);
  };
  return LineAt(world, utime, motor_angle, way);
}

LineScan Scanner::LineAt(const World& world, Utime utime,
                         const std::function<double(double seconds)>& motor_angle,
                         const Way& way) const {
  LineScan scan;
  scan.utime = utime;
  scan.beam_period_s = options_.beam_period_s;
  scan.first_angle_rad = options_.first_angle_rad;
  scan.angle_step_rad = options_.angle_step_rad;
  scan.range.resize(static_cast<std::size_t>(options_.beams));
  scan.intensity.resize(scan.range.size());
  const Noise noise(seed_, scan.utime, "lidar");
  for (int beam = 0; beam < options_.beams; ++beam) {
    const double fired = beam * options_.beam_period_s;
    const BeamReturn back =
        Beam(world, beam, motor_angle(fired), way ? way(utime + FromSeconds(fired)) : Rigid3());
    const auto i = static_cast<std::size_t>(beam);
    scan.range[i] = static_cast<float>(back.range + RangeError(options_, back) +
                                       RangeSigma(options_, back) * noise.Normal(2 * i));
    scan.intensity[i] = NoisyIntensity(options_, back, noise.Normal(2 * i + 1));
  }
  return scan;
}

void Scanner::AddLine(const LineScan& scan, int line, Cloud* cloud) const {
  const double start = line * ToSeconds(line_period());
  const std::size_t first = static_cast<std::size_t>(line) * scan.range.size();
  for (std::size_t i = 0; i < scan.range.size(); ++i) {
    const double fired = static_cast<double>(i) * options_.beam_period_s;
    const Rigid3 lidar_from_scanner =
        RotationAbout(Eigen::Vector3d::UnitZ(), MotorAngle(start + fired)) *
        geometry_.motor_from_scanner;
    const double a = scan.first_angle_rad + static_cast<double>(i) * scan.angle_step_rad;
    const Eigen::Vector3d direction =
        lidar_from_scanner.rotation * Eigen::Vector3d(std::cos(a), 0, std::sin(a));
    const Eigen::Vector3d& origin = lidar_from_scanner.translation;
    cloud->directions[first + i] = direction.cast<float>();
    cloud->points[first + i] = (origin + double(scan.range[i]) * direction).cast<float>();
    cloud->intensity[first + i] = scan.intensity[i];
    cloud->utime[first + i] = scan.utime + FromSeconds(fired);
    cloud->ring[first + i] = static_cast<std::uint16_t>(i);
  }
  const double middle = start + 0.5 * options_.beams * options_.beam_period_s;
  cloud->origins[static_cast<std::size_t>(line)] = Centre(MotorAngle(middle)).cast<float>();
}

Cloud Scanner::Sweep(const World& world, Utime sweep_utime, int threads, const Way& way) const {
  Cloud cloud;
  cloud.sweep_utime = sweep_utime;
  cloud.lines = sweep_lines();
  cloud.beams = options_.beams;
  const std::size_t size =
      static_cast<std::size_t>(cloud.lines) * static_cast<std::size_t>(cloud.beams);
  cloud.points.resize(size);
  cloud.directions.resize(size);
  cloud.intensity.resize(size);
  cloud.utime.resize(size);
  cloud.ring.resize(size);
  cloud.origins.resize(static_cast<std::size_t>(cloud.lines));
  ForEach(cloud.lines, threads,
          [&](int line) { AddLine(Line(world, sweep_utime, line, way), line, &cloud); });
  return cloud;
}

}  // namespace rgbdt::simulate
