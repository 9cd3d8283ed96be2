#include "calib/simulate/internal/drive.h"

#include <cmath>

#include "calib/simulate/internal/dice.h"
#include "calib/simulate/internal/room.h"
#include "calib/simulate/internal/street.h"

namespace rgbdt::simulate {
namespace {

/// Way along x [m], folded to stay within +- `reach`.
double Folded(double way, double reach) {
  const double round = std::fmod(way + reach, 4 * reach);
  return (round < 2 * reach ? round : 4 * reach - round) - reach;
}

}  // namespace

Rigid3 WorldFromLidar(const Options& options, int index) {
  const NaturalOptions& o = options.natural;
  if (o.step_m == 0) return {};
  Dice phase(options.seed, 0, "drive");
  Dice draw(options.seed, index, "drive");
  const bool indoors = options.scene == Scene::kIndoor;
  const double way = o.step_m * (index + draw.Between(-0.2, 0.2));
  const double aside = (indoors ? kRoomFree : 0.5 * kStreetFree) * draw.Between(-0.7, 0.7);
  // Swings there and back, so that it looks along the street however long it drives.
  const double swing = 1.4 * std::sin(0.8 * index + phase.Between(0, 2 * M_PI));
  const double yaw = o.turn_rad * (swing + draw.Between(-0.6, 0.6));
  const double pitch = 0.3 * o.turn_rad * draw.Between(-1, 1);
  const double roll = 0.3 * o.turn_rad * draw.Between(-1, 1);
  Rigid3 pose;
  pose.rotation = (RotationAbout(Eigen::Vector3d::UnitZ(), yaw).rotation *
                   RotationAbout(Eigen::Vector3d::UnitY(), pitch).rotation *
                   RotationAbout(Eigen::Vector3d::UnitX(), roll).rotation)
                      .normalized();
  pose.translation = {indoors ? Folded(way, kRoomFree) : way, aside, 0};
  return pose;
}

}  // namespace rgbdt::simulate
