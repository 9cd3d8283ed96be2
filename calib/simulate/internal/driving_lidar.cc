#include "calib/simulate/internal/driving_lidar.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "calib/model/parallel.h"
#include "calib/simulate/internal/beam.h"
#include "calib/simulate/internal/dice.h"
#include "calib/simulate/internal/noise.h"

namespace rgbdt::simulate {
namespace {

using Eigen::Vector3d;

Rigid3 Turned(double yaw, double pitch, double roll) {
  return RotationAbout(Vector3d::UnitZ(), yaw) * RotationAbout(Vector3d::UnitY(), pitch) *
         RotationAbout(Vector3d::UnitX(), roll);
}

}  // namespace

Way StreetWay(std::uint64_t seed, double speed, double aside_m, double at_rest_s) {
  Dice draw(seed, 0, "street way");
  double phase[5];
  for (double& p : phase) p = draw.Between(0, 2 * M_PI);
  const std::vector<double> p(phase, phase + 5);
  return [=](double seconds) {
    // Sets off softly: within two seconds.
    const double t = std::max(0.0, seconds - at_rest_s);
    const double soft = at_rest_s > 0 ? (t < 2 ? t * t / 4 : t - 1) : t;
    const double way = speed * (soft + 0.2 / 0.9 * (std::sin(0.9 * soft + p[0]) - std::sin(p[0])));
    const double aside = aside_m * std::sin(way / 9 + p[1]);
    const double heading = std::atan(aside_m / 9 * std::cos(way / 9 + p[1]));
    Rigid3 pose = Turned(heading, 0.6 * kDegree * std::sin(1.1 * way + p[2]),
                         0.8 * kDegree * std::sin(0.8 * way + p[3]));
    pose.translation = {way, aside, 0.02 * std::sin(0.9 * way + p[4])};
    return pose;
  };
}

Way RoomWay(std::uint64_t seed, double speed) {
  Dice draw(seed, 0, "room way");
  const double radius = 0.8;
  const double a = draw.Between(0, 2 * M_PI), b = draw.Between(0, 2 * M_PI);
  return [=](double seconds) {
    const double round = speed * seconds / radius;
    Rigid3 pose = Turned(round + 0.3 * std::sin(1.3 * seconds + a),
                         0.02 * std::sin(2 * seconds + b), 0.02 * std::sin(1.7 * seconds + a));
    pose.translation = {radius * std::cos(round + b), radius * std::sin(round + b),
                        0.02 * std::sin(2.1 * seconds)};
    return pose;
  };
}

Cloud MovingSweep(const World& world, const SpinningOptions& lidar, std::uint64_t seed, Utime utime,
                  const std::function<Rigid3(Utime)>& world_from_lidar) {
  const Utime revolution = FromSeconds(lidar.revolution_s);
  Cloud cloud;
  cloud.sweep_utime = utime;
  cloud.lines = lidar.rings();
  cloud.beams = lidar.columns();
  const auto size = static_cast<std::size_t>(cloud.lines) * static_cast<std::size_t>(cloud.beams);
  cloud.points.resize(size);
  cloud.directions.resize(size);
  cloud.intensity.resize(size);
  cloud.utime.resize(size);
  cloud.ring.resize(size);
  const Noise noise(seed, cloud.sweep_utime, "moving lidar");
  std::vector<std::vector<Vector3d>> beams;
  for (const double elevation : lidar.elevations_rad) {
    beams.push_back(SubRays(lidar, elevation));
  }
  const auto rays = static_cast<int>(beams.front().size());
  ForEach(cloud.beams, 0, [&](int column) {
    const Utime fired = utime + revolution * column / cloud.beams;
    const Rigid3 pose = world_from_lidar(fired);
    const double azimuth = lidar.first_azimuth_rad + column * 360 * kDegree / cloud.beams;
    const Eigen::Quaterniond turn = RotationAbout(Vector3d::UnitZ(), azimuth).rotation;
    std::vector<Vector3d> directions;
    for (const std::vector<Vector3d>& beam : beams) {
      for (const Vector3d& ray : beam) directions.push_back(pose.rotation * (turn * ray));
    }
    std::vector<BeamReturn> returns(beams.size());
    CastBeams(world, lidar, pose.translation, directions, rays, returns.data());
    for (std::size_t ring = 0; ring < beams.size(); ++ring) {
      const std::size_t i =
          ring * static_cast<std::size_t>(cloud.beams) + static_cast<std::size_t>(column);
      const Vector3d direction = turn * beams[ring].front();
      const double range =
          returns[ring].range + lidar.range_sigma_m * noise.Normal(static_cast<std::uint64_t>(i));
      cloud.directions[i] = direction.cast<float>();
      cloud.points[i] = (range * direction).cast<float>();  // of a miss: NaN
      cloud.intensity[i] = static_cast<float>(std::min(1.0, returns[ring].intensity));
      cloud.utime[i] = fired;
      cloud.ring[i] = static_cast<std::uint16_t>(ring);
    }
  });
  return cloud;
}

}  // namespace rgbdt::simulate
