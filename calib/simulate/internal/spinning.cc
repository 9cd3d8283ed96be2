#include "calib/simulate/internal/spinning.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "calib/model/parallel.h"
#include "calib/simulate/internal/noise.h"

namespace rgbdt::simulate {
namespace {

Eigen::Vector3d Turned(const Eigen::Vector3d& v, double azimuth) {
  const double c = std::cos(azimuth);
  const double s = std::sin(azimuth);
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y(), v.z()};
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

// `block` columns at once, from where the first one of them is fired.
std::vector<BeamReturn> CastInBlocks(const World& world, const SpinningOptions& options,
                                     const Ring& ring, int block,
                                     const std::function<Rigid3(int column)>& world_from_lidar) {
  std::vector<BeamReturn> returns(static_cast<std::size_t>(ring.columns()));
  std::vector<Eigen::Vector3d> directions;
  for (int first = 0; first < ring.columns(); first += block) {
    const Rigid3 pose = world_from_lidar(first);
    const Eigen::Matrix3d rotation = pose.rotation.toRotationMatrix();
    const int end = std::min(first + block, ring.columns());
    directions.clear();
    for (int column = first; column < end; ++column) {
      for (const Eigen::Vector3d& ray : ring.SubRays(column)) {
        directions.emplace_back(rotation * ray);
      }
    }
    CastBeams(world, options, rotation * ring.start() + pose.translation, directions,
              static_cast<int>(directions.size()) / (end - first),
              &returns[static_cast<std::size_t>(first)]);
  }
  return returns;
}

void FillRing(const SpinningOptions& options, const std::vector<BeamReturn>& returns,
              const Noise& noise, double bias, const Ring& ring, Cloud* cloud) {
  for (int column = 0; column < cloud->beams; ++column) {
    const BeamReturn& back = returns[static_cast<std::size_t>(column)];
    const std::size_t i =
        static_cast<std::size_t>(ring.index()) * returns.size() + static_cast<std::size_t>(column);
    const Eigen::Vector3d direction = ring.Direction(column);
    const double range = back.range + (bias + RangeError(options, back)) +
                         RangeSigma(options, back) * noise.Normal(2 * i);
    cloud->directions[i] = direction.cast<float>();
    cloud->points[i] = (range * direction).cast<float>();  // of a miss: NaN
    cloud->intensity[i] = NoisyIntensity(options, back, noise.Normal(2 * i + 1));
    cloud->utime[i] = cloud->sweep_utime + ring.FiredAfter(column);
    cloud->ring[i] = static_cast<std::uint16_t>(ring.index());
  }
}

}  // namespace

Ring::Ring(const SpinningOptions& options, int index)
    : options_(options), index_(index), columns_(options.columns()) {
  const double elevation = options.elevations_rad[static_cast<std::size_t>(index)];
  along_ = {std::cos(elevation), 0, std::sin(elevation)};
  start_ = {0, 0, -options.beams_meet_m * std::tan(elevation)};
  sub_rays_ = simulate::SubRays(options, elevation);
}

double Ring::Place(int column) const {
  return column + options_.firing_share * index_ / options_.rings();
}

double Ring::Azimuth(int column) const {
  return options_.first_azimuth_rad + Place(column) * 360 * kDegree / columns_;
}

Utime Ring::FiredAfter(int column) const {
  return FromSeconds(Place(column) * options_.revolution_s / columns_);
}

Eigen::Vector3d Ring::Direction(int column) const { return Turned(along_, Azimuth(column)); }

std::vector<Eigen::Vector3d> Ring::SubRays(int column) const {
  const double azimuth = Azimuth(column);
  std::vector<Eigen::Vector3d> rays;
  rays.reserve(sub_rays_.size());
  for (const Eigen::Vector3d& ray : sub_rays_) rays.push_back(Turned(ray, azimuth));
  return rays;
}

double RingBias(const SpinningOptions& options, std::uint64_t seed, int ring) {
  const Noise noise(seed, 0, "ring bias");
  return options.ring_bias_sigma_m * noise.Normal(static_cast<std::uint64_t>(ring));
}

Cloud SpinningSweep(const SpinningOptions& options, std::uint64_t seed, Utime utime, int threads,
                    const CastRing& cast) {
  options.Check();
  Cloud cloud = EmptyGrid(options, utime);
  const Noise noise(seed, utime, "spinning lidar");
  ForEach(options.rings(), threads, [&](int index) {
    const Ring ring(options, index);
    FillRing(options, cast(ring), noise, RingBias(options, seed, index), ring, &cloud);
  });
  return cloud;
}

std::vector<BeamReturn> CastStanding(const World& world, const SpinningOptions& options,
                                     const Ring& ring, const Rigid3& world_from_lidar) {
  constexpr int kBlock = 16;  // rays of neighbours fill the ray caster's packets
  return CastInBlocks(world, options, ring, kBlock, [&](int) { return world_from_lidar; });
}

Cloud SpinningSweep(const World& world, const SpinningOptions& options, std::uint64_t seed,
                    Utime utime, int threads, const Rigid3& world_from_lidar) {
  return SpinningSweep(options, seed, utime, threads, [&](const Ring& ring) {
    return CastStanding(world, options, ring, world_from_lidar);
  });
}

Cloud MovingSweep(const World& world, const SpinningOptions& options, std::uint64_t seed,
                  Utime utime, const std::function<Rigid3(Utime)>& world_from_lidar, int threads) {
  return SpinningSweep(options, seed, utime, threads, [&](const Ring& ring) {
    return CastInBlocks(world, options, ring, 1, [&](int column) {
      return world_from_lidar(utime + ring.FiredAfter(column));
    });
  });
}

}  // namespace rgbdt::simulate
