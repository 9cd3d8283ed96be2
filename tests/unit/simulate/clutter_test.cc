#include "calib/simulate/internal/clutter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "calib/model/errors.h"
#include "calib/simulate/internal/cloud_world.h"
#include "calib/simulate/internal/holder.h"
#include "tests/unit/simulate/simulate_testing.h"

namespace rgbdt::simulate {
namespace {

using Eigen::Vector3d;

struct Kind {
  const char* name;
  bool ClutterOptions::*wanted;
};
constexpr Kind kKinds[] = {{"door leaf", &ClutterOptions::door},
                           {"poster", &ClutterOptions::poster},
                           {"table top", &ClutterOptions::table},
                           {"panel", &ClutterOptions::panel},
                           {"second board", &ClutterOptions::second_board}};

/// Everything at once needs more than the turned scanner's field.
Options Cluttered(std::uint64_t seed, Scene scene) {
  Options options;
  options.seed = seed;
  options.scene = scene;
  for (const Kind& kind : kKinds) options.clutter.*kind.wanted = true;
  options.clutter.max_azimuth_rad = 80 * kDegree;
  return options;
}

const SceneObject& Find(const SceneModel& scene, const std::string& name) {
  // The last: a scene may have things of its own by that name.
  for (auto object = scene.objects.rbegin(); object != scene.objects.rend(); ++object) {
    if (object->name == name) return *object;
  }
  throw std::logic_error("no " + name);
}

/// What a fan of rays meets, 0.1 x 0.2 degrees apart, up to this far to either side.
std::multiset<std::string> Seen(const World& world, int degrees) {
  std::multiset<std::string> names;
  for (int i = -10 * degrees; i <= 10 * degrees; ++i) {
    for (int j = -150; j <= 150; ++j) {
      const double azimuth = 0.1 * i * kDegree;
      const double elevation = 0.2 * j * kDegree;
      const Hit hit = world.caster().Cast(
          Vector3d::Zero(), {std::cos(elevation) * std::cos(azimuth),
                             std::cos(elevation) * std::sin(azimuth), std::sin(elevation)});
      if (hit.hit() && !world.IsBoard(hit)) names.insert(world.Object(hit).name);
    }
  }
  return names;
}

/// At 8 m a ray stands for 1.4 cm x 2.8 cm; of a table's top at 8 m there are few.
std::size_t LeastRays(const std::string& name) { return name == "table top" ? 25 : 300; }

TEST(Clutter, IsOffUnlessSwitchedOn) {
  EXPECT_FALSE(ClutterOptions().any());
  for (const SceneObject& object : MakeScene(Options()).objects) {
    EXPECT_EQ(object.name.find("clutter"), std::string::npos);
    EXPECT_FALSE(object.pattern);
  }
}

TEST(Clutter, IsSeenByTheTurnedScannerInEveryScene) {
  for (const Kind& kind : kKinds) {
    for (const Scene scene : {Scene::kOutdoor, Scene::kIndoor}) {
      for (const std::uint64_t seed : {1, 2, 3}) {
        Options options;
        options.seed = seed;
        options.scene = scene;
        options.clutter.*kind.wanted = true;
        const CloudWorld world(options, std::nullopt);
        EXPECT_GT(Seen(world.world(), 30).count(kind.name), LeastRays(kind.name))
            << kind.name << " seed " << seed;
        EXPECT_NO_THROW(CloudWorld(options, 0)) << kind.name << " seed " << seed;
      }
    }
  }
}

TEST(Clutter, MayBeAllKindsAtOnce) {
  for (const Scene scene : {Scene::kOutdoor, Scene::kIndoor}) {
    for (const std::uint64_t seed : {1, 2, 3}) {
      const Options options = Cluttered(seed, scene);
      const CloudWorld world(options, std::nullopt);
      const std::multiset<std::string> seen = Seen(world.world(), 90);
      for (const Kind& kind : kKinds) EXPECT_GT(seen.count(kind.name), LeastRays(kind.name));
      for (int index = 0; index < 4; ++index) EXPECT_NO_THROW(CloudWorld(options, index));
    }
  }
}

TEST(Clutter, HasItsSizes) {
  const SceneModel scene = MakeScene(Cluttered(1, Scene::kOutdoor));
  const auto diagonal = [&](const char* name) {
    const std::vector<Vector3d>& v = Find(scene, name).mesh.vertices;
    return (v[7] - v[0]).norm();  // opposite corners of a box
  };
  EXPECT_NEAR(diagonal("door leaf"), Vector3d(0.9, 2.0, 0.04).norm(), 1e-9);
  EXPECT_NEAR(diagonal("poster"), Vector3d(1.0, 0.7, 0.001).norm(), 1e-9);
  EXPECT_NEAR(diagonal("table top"), Vector3d(1.2, 0.8, 0.03).norm(), 1e-9);
  EXPECT_NEAR(diagonal("panel"), Vector3d(1.3, 1.0, 0.02).norm(), 1e-9);
  EXPECT_NEAR(diagonal("second board"), Vector3d(1.2192, 0.9144, 0.015).norm(), 1e-9);
  for (const Vector3d& v : Find(scene, "table top").mesh.vertices) {
    EXPECT_NEAR(v.z(), -1.2 + 0.75 - 0.015, 0.0151);
  }
}

TEST(Clutter, PosterIsFlushAndTheDoorIsNot) {
  const ClutterThing poster = MakePoster({});
  for (const Vector3d& v : poster.parts[1].mesh.vertices) EXPECT_LE(std::abs(v.x()), 0.001);
  EXPECT_GT(poster.parts[0].material.reflectivity, 2 * poster.parts[1].material.reflectivity);
  double nearest = 0;
  const ClutterThing door = MakeDoor({});
  for (const Vector3d& v : door.parts[1].mesh.vertices) {
    EXPECT_LT(v.x(), -0.04);  // the wall's face is x = 0
    nearest = std::min(nearest, v.x());
  }
  EXPECT_LT(nearest, -0.9 * std::sin(15 * kDegree));
}

TEST(Clutter, SecondBoardHasItsPattern) {
  const CloudWorld cloud_world(Cluttered(1, Scene::kOutdoor), std::nullopt);
  const World& world = cloud_world.world();
  const std::shared_ptr<const Board> board = Find(world.scene(), "second board").pattern;
  ASSERT_TRUE(board);
  const auto reflectivity = [&](const Vector3d& place) {
    const Vector3d point = board->lidar_from_target() * place;
    const Hit hit = world.caster().Cast(Vector3d::Zero(), point.normalized());
    EXPECT_NEAR(hit.range, point.norm(), 1e-3);
    int patch = world.At(hit, hit.range * point.normalized(), 0.001).patch;
    EXPECT_EQ(patch, board->Patch(place.head<2>()));
    return world.Reflectivity(hit, hit.range * point.normalized());
  };
  EXPECT_NEAR(reflectivity({-0.5, -0.35, 0}), 0.08, 1e-9);
  EXPECT_NEAR(reflectivity({-0.4, -0.35, 0}), 0.7, 1e-9);
}

TEST(Clutter, SaysWhenThereIsNoRoom) {
  Options options = Cluttered(1, Scene::kIndoor);
  options.clutter.near_m = options.clutter.far_m = 30;  // outside the room
  EXPECT_THROW(MakeScene(options), InputError);
}

/// A board whose x is level, at 4 m.
CloudWorld HeldBoard(Holder holder, double roll = 0, double tilt = 0) {
  Options options;
  options.clutter.holder = holder;
  Eigen::Matrix3d axes;
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  Rigid3 pose;
  pose.rotation = Eigen::Quaterniond(axes) * RotationAbout(Vector3d::UnitX(), tilt).rotation *
                  RotationAbout(Vector3d::UnitZ(), roll).rotation;
  pose.translation = {4, 0.3, 0};
  return {options, std::optional<Rigid3>(pose)};
}

/// What a ray towards a place in the target frame meets, and where (target frame).
std::string Towards(const CloudWorld& cloud_world, const Vector3d& place, Vector3d* met) {
  const Vector3d direction = (cloud_world.lidar_from_target() * place).normalized();
  const World& world = cloud_world.world();
  const Hit hit = world.caster().Cast(Vector3d::Zero(), direction);
  if (!hit.hit()) return "";
  *met = cloud_world.lidar_from_target().Inverse() * (hit.range * direction);
  return world.IsBoard(hit) ? "board" : world.Object(hit).name;
}

TEST(Holder, HandsGripTheBorderFromLeftAndRight) {
  for (const double roll : {0.0, 90 * kDegree, 180 * kDegree}) {
    const CloudWorld world = HeldBoard(Holder::kPerson, roll);
    const bool turned = std::abs(roll - 90 * kDegree) < 0.1;
    Vector3d met;
    for (const double side : {-1.0, 1.0}) {
      const Vector3d out = turned ? Vector3d(0, side, 0) : Vector3d(side, 0, 0);
      const double edge = turned ? 0.9144 / 2 : 1.2192 / 2;
      EXPECT_EQ(Towards(world, (edge - 0.02) * out, &met), "hand");
      EXPECT_LT(met.z(), -0.01);  // in front of the board
      EXPECT_EQ(Towards(world, (edge + 0.02) * out, &met), "hand");
      EXPECT_EQ(Towards(world, (edge - 0.06) * out, &met), "board");
    }
    EXPECT_EQ(Towards(world, {0, 0, 0}, &met), "board");
  }
}

TEST(Holder, BodyStandsCloseBehindTheBoard) {
  for (const double tilt : {-50 * kDegree, -20 * kDegree, 0.0, 20 * kDegree, 50 * kDegree}) {
    const CloudWorld world = HeldBoard(Holder::kPerson, 0, tilt);
    const Rigid3 target_from_lidar = world.lidar_from_target().Inverse();
    double nearest = 1e9;
    for (const SceneObject& part : MakeHolder(*world.world().board(), Options(), 297)) {
      EXPECT_NE(part.name, "body");  // these options ask for a stand
    }
    Options options;
    options.clutter.holder = Holder::kPerson;
    for (const SceneObject& part : MakeHolder(*world.world().board(), options, 297)) {
      if (part.name != "body" && part.name != "head") continue;
      for (const Vector3d& vertex : part.mesh.vertices) {
        const Vector3d p = target_from_lidar * vertex;
        EXPECT_GT(vertex.z(), -1.2 - 0.1);
        if (std::abs(p.x()) < 0.6 && std::abs(p.y()) < 0.45) nearest = std::min(nearest, p.z());
      }
    }
    EXPECT_GE(nearest, 0.015 + 0.15 - 1e-6) << tilt;
    // Tilted, the nearest part may be one that stands just above or below the board.
    EXPECT_LT(nearest, tilt == 0 ? 0.015 + 0.15 + 1e-6 : 0.5) << tilt;
  }
}

TEST(Holder, EaselIsFlushBelowTheBoard) {
  for (const double roll : {0.0, 90 * kDegree, 180 * kDegree, -90 * kDegree}) {
    const CloudWorld world = HeldBoard(Holder::kEasel, roll, 15 * kDegree);
    const Vector3d down = RotationAbout(Vector3d::UnitZ(), -roll) * Vector3d::UnitY();
    const Vector3d side = RotationAbout(Vector3d::UnitZ(), -roll) * Vector3d::UnitX();
    const bool upright = std::abs(down.y()) > 0.5;
    const double edge = upright ? 0.9144 / 2 : 1.2192 / 2;
    const double width = upright ? 1.2192 : 0.9144;
    Vector3d met;
    for (const double along : {-0.45, 0.0, 0.45}) {
      EXPECT_EQ(Towards(world, (edge + 0.05) * down + along * width * side, &met), "easel");
      EXPECT_NEAR(met.z(), 0, 1e-5);
    }
    EXPECT_EQ(Towards(world, (edge + 0.2) * down + 0.3 * width * side, &met), "easel");
    EXPECT_NEAR(met.z(), 0, 1e-5);
    EXPECT_NE(Towards(world, (edge + 0.2) * down + 0.15 * width * side, &met), "easel");
    EXPECT_NE(Towards(world, -(edge + 0.05) * down, &met), "easel");
  }
}

}  // namespace
}  // namespace rgbdt::simulate
