#include "calib/simulate/internal/spinning.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "calib/model/parallel.h"
#include "calib/simulate/internal/beam.h"
#include "calib/simulate/internal/noise.h"

namespace rgbdt::simulate {
namespace {

/// How many beams are cast at once: rays of neighbours fill the ray caster's packets.
constexpr int kBlock = 16;

Eigen::Vector3d Turned(const Eigen::Vector3d& v, double azimuth) {
  const double c = std::cos(azimuth);
  const double s = std::sin(azimuth);
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y(), v.z()};
}

/// Rings of one column fire at these places on the way to the next column, in steps.
double ColumnOf(const SpinningOptions& options, int ring, int column) {
  return column + options.firing_share * ring / options.rings();
}

double Azimuth(const SpinningOptions& options, int ring, int column) {
  return options.first_azimuth_rad +
         ColumnOf(options, ring, column) * 360 * kDegree / options.columns();
}

Cloud EmptyGrid(const SpinningOptions& options, Utime utime) {
  Cloud cloud;
  cloud.sweep_utime = utime;
  cloud.lines = options.rings();
  cloud.beams = options.columns();
  const auto size = static_cast<std::size_t>(cloud.lines) * static_cast<std::size_t>(cloud.beams);
  cloud.points.resize(size);
  cloud.directions.resize(size);
  cloud.intensity.resize(size);
  cloud.utime.resize(size);
  cloud.ring.resize(size);
  return cloud;
}

/// A ring of beams, without noise.
std::vector<BeamReturn> CastRing(const World& world, const SpinningOptions& options,
                                 const Rigid3& world_from_lidar, int ring) {
  const double elevation = options.elevations_rad[static_cast<std::size_t>(ring)];
  const Eigen::Matrix3d rotation = world_from_lidar.rotation.toRotationMatrix();
  const Eigen::Vector3d start =
      rotation * Eigen::Vector3d(0, 0, -options.beams_meet_m * std::tan(elevation)) +
      world_from_lidar.translation;
  const std::vector<Eigen::Vector3d> sub_rays = SubRays(options, elevation);
  std::vector<BeamReturn> returns(static_cast<std::size_t>(options.columns()));
  std::vector<Eigen::Vector3d> directions;
  for (int first = 0; first < options.columns(); first += kBlock) {
    directions.clear();
    for (int column = first; column < std::min(first + kBlock, options.columns()); ++column) {
      const double azimuth = Azimuth(options, ring, column);
      for (const Eigen::Vector3d& ray : sub_rays) {
        directions.emplace_back(rotation * Turned(ray, azimuth));
      }
    }
    CastBeams(world, options, start, directions, static_cast<int>(sub_rays.size()),
              &returns[static_cast<std::size_t>(first)]);
  }
  return returns;
}

void FillRing(const SpinningOptions& options, const std::vector<BeamReturn>& returns,
              const Noise& noise, double bias, int ring, Cloud* cloud) {
  const double elevation = options.elevations_rad[static_cast<std::size_t>(ring)];
  const Eigen::Vector3d along(std::cos(elevation), 0, std::sin(elevation));
  for (int column = 0; column < cloud->beams; ++column) {
    const BeamReturn& back = returns[static_cast<std::size_t>(column)];
    const std::size_t i =
        static_cast<std::size_t>(ring) * returns.size() + static_cast<std::size_t>(column);
    const Eigen::Vector3d direction = Turned(along, Azimuth(options, ring, column));
    const double range = back.range + (bias + RangeError(options, back)) +
                         RangeSigma(options, back) * noise.Normal(2 * i);
    cloud->directions[i] = direction.cast<float>();
    cloud->points[i] = (range * direction).cast<float>();  // of a miss: NaN
    cloud->intensity[i] = NoisyIntensity(options, back, noise.Normal(2 * i + 1));
    cloud->utime[i] = cloud->sweep_utime + FromSeconds(ColumnOf(options, ring, column) *
                                                       options.revolution_s / cloud->beams);
    cloud->ring[i] = static_cast<std::uint16_t>(ring);
  }
}

}  // namespace

double RingBias(const SpinningOptions& options, std::uint64_t seed, int ring) {
  const Noise noise(seed, 0, "ring bias");
  return options.ring_bias_sigma_m * noise.Normal(static_cast<std::uint64_t>(ring));
}

Cloud SpinningSweep(const World& world, const SpinningOptions& options, std::uint64_t seed,
                    Utime utime, int threads, const Rigid3& world_from_lidar) {
  options.Check();
  Cloud cloud = EmptyGrid(options, utime);
  const Noise noise(seed, utime, "spinning lidar");
  ForEach(options.rings(), threads, [&](int ring) {
    const double bias = RingBias(options, seed, ring);
    FillRing(options, CastRing(world, options, world_from_lidar, ring), noise, bias, ring, &cloud);
  });
  return cloud;
}

}  // namespace rgbdt::simulate
