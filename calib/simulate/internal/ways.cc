#include "calib/simulate/internal/ways.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "calib/simulate/internal/dice.h"

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

}  // namespace rgbdt::simulate
