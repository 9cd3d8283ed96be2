#include "tests/study/drives.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "calib/simulate/internal/dice.h"
#include "calib/simulate/internal/room.h"
#include "calib/simulate/internal/street.h"
#include "calib/simulate/internal/things.h"

namespace rgbdt::study {
namespace {

using Eigen::Vector3d;
using simulate::kDegree;

constexpr Utime kStart = 1'700'000'000'000'000;
constexpr double kCell = 8;  // [m] after which the street is made anew

Rigid3 Turned(double yaw, double pitch, double roll) {
  return RotationAbout(Vector3d::UnitZ(), yaw) * RotationAbout(Vector3d::UnitY(), pitch) *
         RotationAbout(Vector3d::UnitX(), roll);
}

std::vector<simulate::SceneObject> Corridor(std::uint64_t seed, double ground) {
  simulate::Dice draw(seed, 0, "corridor");
  const double half = draw.Between(0.8, 1.6), top = ground + draw.Between(2.3, 3.2);
  const double ends = 300;
  const auto wall = simulate::Paint(simulate::Rgb(0.6, 0.6, 0.6), 0.6, 295);
  const auto quad = [&](const Vector3d& a, const Vector3d& b) {
    // From one long edge to the other.
    return simulate::MakeQuad({-ends, a.y(), a.z()}, {ends, a.y(), a.z()}, {ends, b.y(), b.z()},
                              {-ends, b.y(), b.z()});
  };
  const Vector3d a(0, -half, ground), b(0, half, ground), c(0, half, top), d(0, -half, top);
  return {{"floor", quad(a, b), wall},
          {"left", quad(b, c), wall},
          {"ceiling", quad(c, d), wall},
          {"right", quad(d, a), wall}};
}

std::vector<simulate::SceneObject> Plain(double ground) {
  return {{"ground",
           simulate::MakeQuad({-500, -500, ground}, {500, -500, ground}, {500, 500, ground},
                              {-500, 500, ground}),
           simulate::Paint(simulate::Rgb(0.3, 0.4, 0.2), 0.5, 295)}};
}

// Where the middle of the streets about a block lies, by the way since its first corner: straight
// on, and a quarter turn to the left over kCorner, as smooth as a polynomial of the fifth degree.
constexpr double kSide = 80;    // [m] from crossing to crossing
constexpr double kCorner = 16;  // [m]

double CornerHeading(double way) {
  const double u = std::clamp(way / kCorner, 0.0, 1.0);
  return 0.5 * M_PI * u * u * u * (10 + u * (6 * u - 15));
}

class BlockLine {
 public:
  BlockLine() {
    // Midpoints, and the turn is symmetric: off by less than a micrometre.
    Eigen::Vector2d place(0, 0);
    for (int i = 0; i < kSteps; ++i) {
      corner_.push_back(place);
      const double heading = CornerHeading((i + 0.5) * kCorner / kSteps);
      place += kCorner / kSteps * Eigen::Vector2d(std::cos(heading), std::sin(heading));
    }
    corner_.push_back(place);
    straight_ = kSide - 2 * place.x();
  }
  double round() const { return 4 * (straight_ + kCorner); }
  /// x, y [m] and heading [rad]; way 0: behind the first corner.
  Eigen::Vector3d At(double way) const {
    const double quarter = straight_ + kCorner;
    const double leg = std::floor(way / quarter), along = way - leg * quarter;
    const double in_corner = along - straight_;
    Eigen::Vector2d place(corner_.back().x() + std::min(along, straight_), 0);
    if (in_corner > 0) {
      const double step = in_corner / kCorner * kSteps;
      const auto i = std::min<std::size_t>(kSteps - 1, static_cast<std::size_t>(step));
      place += corner_[i] + (step - static_cast<double>(i)) * (corner_[i + 1] - corner_[i]);
    }
    const Vector3d turned = WorldFromLeg(leg) * Vector3d(place.x(), place.y(), 0);
    return {turned.x(), turned.y(), 0.5 * M_PI * leg + CornerHeading(in_corner)};
  }
  /// x along the leg's street, from crossing to crossing.
  static Rigid3 WorldFromLeg(double leg) {
    const int corner = static_cast<int>(leg - 4 * std::floor(leg / 4));
    Rigid3 pose = Turned(0.5 * M_PI * corner, 0, 0);
    pose.translation = {corner == 1 || corner == 2 ? kSide : 0, corner >= 2 ? kSide : 0, 0};
    return pose;
  }

 private:
  static constexpr int kSteps = 1600;
  std::vector<Eigen::Vector2d> corner_;
  double straight_;
};

// How far a rig is that sets off and stops softly, on a stretch of `length` [m], and for how long.
struct Stretch {
  static constexpr double kTurning = 5;  // [s] for half a turn
  static constexpr double kBraking = 3;  // [m/s^2]
  double length, speed;

  double Ramp() const { return speed / kBraking; }
  double Seconds() const { return length / speed + Ramp(); }
  double At(double t) const {
    const double after = std::clamp(t, 0.0, Seconds()), rest = Seconds() - after;
    if (after < Ramp()) return 0.5 * kBraking * after * after;
    if (rest < Ramp()) return length - 0.5 * kBraking * rest * rest;
    return speed * (after - 0.5 * Ramp());
  }
};

bool StandsInTheWay(const simulate::SceneObject& object, double ground, const BlockLine& line) {
  constexpr double kFree = 1.35, kFlat = 0.2;  // [m]
  const simulate::Bounds bounds = simulate::BoundsOf(object.mesh);
  if (bounds.high.z() < ground + kFlat) return false;
  for (double way = 0; way < line.round(); way += 0.5) {
    const Eigen::Vector2d place = line.At(way).head<2>();
    const Eigen::Vector2d nearest =
        place.cwiseMax(bounds.low.head<2>()).cwiseMin(bounds.high.head<2>());
    if ((place - nearest).norm() < kFree) return true;
  }
  return false;
}

}  // namespace

double BlockRound() { return BlockLine().round(); }

double ThereAndBackSeconds(double length, double speed) {
  return 2 * Stretch{length, speed}.Seconds() + Stretch::kTurning;
}

Way ThereAndBackWay(double length, double speed) {
  constexpr double kAside = 0.5;  // [m] of the street's middle
  const Stretch stretch{length, speed};
  return [stretch](double seconds) {
    const double after = seconds - stretch.Seconds();
    const double u = std::clamp(after / Stretch::kTurning, 0.0, 1.0);
    const double turned = u * u * u * (10 + u * (6 * u - 15));
    const double back = stretch.At(after - Stretch::kTurning);
    const double x = stretch.At(seconds) - back, way = stretch.At(seconds) + back;
    Rigid3 pose = Turned(M_PI * turned, 0.01 * std::sin(1.1 * way), 0.014 * std::sin(0.8 * way));
    pose.translation = {x, kAside * std::cos(M_PI * turned), 0.02 * std::sin(0.9 * way)};
    return pose;
  };
}

Way BlockWay(std::uint64_t seed, double speed) {
  const Way street = StreetWay(seed, speed);
  const auto line = std::make_shared<const BlockLine>();
  return [=](double seconds) {
    const Rigid3 along = street(seconds);
    const Vector3d middle = line->At(along.translation.x());
    Rigid3 block = Turned(middle.z(), 0, 0);
    block.translation = {middle.x(), middle.y(), 0};
    Rigid3 aside = along;
    aside.translation.x() = 0;
    return block * aside;
  };
}

Way SlowRoomWay(std::uint64_t seed, double speed_mps) {
  const double a = 2 * M_PI * static_cast<double>(seed % 97) / 97;
  return [a, speed_mps](double seconds) {
    constexpr double kRadius = 0.8;
    const double way = speed_mps * seconds;
    const double round = a + way / kRadius;
    Rigid3 pose = Turned(round + 0.3 * std::sin(0.9 * way + a), 0.02 * std::sin(2.3 * way),
                         0.015 * std::sin(1.7 * way));
    pose.translation = {kRadius * std::cos(round), kRadius * std::sin(round),
                        0.02 * std::sin(2.1 * way)};
    return pose;
  };
}

Drive::Drive(DriveScene scene, std::uint64_t seed, const simulate::SpinningOptions& lidar, Way way)
    : scene_(scene), lidar_(lidar), way_(std::move(way)) {
  lidar_.Check();
  options_.seed = seed;
  options_.natural.on = true;
  options_.natural.people = 0;
  options_.scene =
      scene == DriveScene::kRoom ? simulate::Scene::kIndoor : simulate::Scene::kOutdoor;
}

Rigid3 Drive::At(Utime utime) const { return way_(ToSeconds(utime - kStart)); }

// Each street is that of another seed; of twins those that lie opposite are the same.
std::vector<simulate::SceneObject> Drive::Block() const {
  const BlockLine line;
  const double ground = options_.world.ground_z_m;
  std::vector<simulate::SceneObject> objects;
  for (int leg = 0; leg < 4; ++leg) {
    simulate::Options own = options_;
    own.seed = 4 * options_.seed +
               static_cast<std::uint64_t>(scene_ == DriveScene::kTwins ? leg % 2 : leg);
    simulate::Thing street({297, 9});
    // From the crossing on, as far as the houses beyond the next one.
    street.AddAll(BlockLine::WorldFromLeg(leg), simulate::MakeStreet(own, {297, 9}, 20));
    for (const simulate::SceneObject& object : street.parts()) {
      if (!StandsInTheWay(object, ground, line)) objects.push_back(object);
    }
  }
  return objects;
}

void Drive::MakeWorld(double x_m) {
  const double cell = kCell * std::floor(x_m / kCell);
  if (world_ && (scene_ != DriveScene::kStreet || cell == world_x_)) return;
  world_x_ = cell;
  auto scene = std::make_shared<simulate::SceneModel>();
  const double ground = options_.world.ground_z_m;
  switch (scene_) {
    case DriveScene::kStreet:
      scene->objects = simulate::MakeStreet(options_, {297, 9}, cell).parts();
      break;
    case DriveScene::kRoom:
      scene->objects = simulate::MakeRoom(options_, {294, 0}, &scene->lights).parts();
      break;
    case DriveScene::kCorridor:
      scene->objects = Corridor(options_.seed, ground);
      break;
    case DriveScene::kPlain:
      scene->objects = Plain(ground);
      break;
    case DriveScene::kBlock:
    case DriveScene::kTwins:
      scene->objects = Block();
      break;
  }
  world_.emplace(std::move(scene), std::nullopt, options_);
}

Cloud Drive::Sweep(int number) {
  const Utime utime = kStart + number * FromSeconds(lidar_.revolution_s);
  MakeWorld(At(utime).translation.x());
  return MovingSweep(*world_, lidar_, options_.seed, utime, [this](Utime at) { return At(at); });
}

simulate::ScannerOptions QuickScanner() {
  simulate::ScannerOptions scanner = simulate::FullTurnScanner();
  scanner.motor_speed_rad_s *= 8;
  scanner.beams /= 2;
  scanner.angle_step_rad *= 2;
  return scanner;
}

Stops::Stops(std::uint64_t seed, const simulate::ScannerOptions& scanner, double apart_m)
    : scanner_(scanner, seed),
      way_([way = RoomWay(seed, 1), apart_m](double number) { return way(apart_m * number); }) {
  options_.seed = seed;
  options_.scanner = scanner;
  options_.natural.on = true;
  options_.natural.people = 0;
  options_.scene = simulate::Scene::kIndoor;
}

Rigid3 Stops::At(int number) const { return way_(number); }

Cloud Stops::Sweep(int number) const {
  constexpr double kBetween = 10;  // [s] from the end of a sweep to the next one
  const double lasts = scanner_.sweep_lines() * ToSeconds(scanner_.line_period());
  auto scene = std::make_shared<simulate::SceneModel>();
  simulate::Thing room({294, 0});
  room.AddAll(At(number).Inverse(), simulate::MakeRoom(options_, {294, 0}, &scene->lights));
  scene->objects = room.parts();
  const simulate::World world(std::move(scene), std::nullopt, options_);
  return scanner_.Sweep(world, kStart + FromSeconds(number * (lasts + kBetween)), 0);
}

TurningDrive::TurningDrive(std::uint64_t seed, const simulate::ScannerOptions& scanner,
                           double speed_mps)
    : scanner_(scanner, seed) {
  options_.seed = seed;
  options_.scanner = scanner;
  options_.natural.on = true;
  options_.natural.people = 0;
  options_.scene = simulate::Scene::kIndoor;
  auto scene = std::make_shared<simulate::SceneModel>();
  scene->objects = simulate::MakeRoom(options_, {294, 0}, &scene->lights).parts();
  world_ = std::make_shared<const simulate::World>(std::move(scene), std::nullopt, options_);
  // Sets off softly, within two seconds.
  const double stands = ToSeconds(BeginOf(1) - kStart);
  way_ = [way = SlowRoomWay(seed, speed_mps), stands](double seconds) {
    constexpr double kSoft = 2;
    const double driven = std::max(0.0, seconds - stands);
    return way(driven < kSoft ? driven * driven / (2 * kSoft) : driven - kSoft / 2);
  };
}

Utime TurningDrive::BeginOf(int number) const {
  constexpr Utime kBetween = 100'000;  // while the motor turns round
  return kStart + number * (scanner_.sweep_lines() * scanner_.line_period() + kBetween);
}

Rigid3 TurningDrive::At(Utime utime) const { return way_(ToSeconds(utime - kStart)); }

Cloud TurningDrive::StandingSweep(int number) {
  const Utime begin = BeginOf(number);
  return scanner_.Sweep(*world_, begin, 0, [this, begin](Utime) { return At(begin); });
}

Cloud TurningDrive::Sweep(int number) {
  scanner_.SweepBack(number % 2 == 1);
  return scanner_.Sweep(*world_, BeginOf(number), 0, [this](Utime utime) { return At(utime); });
}

}  // namespace rgbdt::study
