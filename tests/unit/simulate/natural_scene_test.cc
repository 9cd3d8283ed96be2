#include "calib/simulate/internal/natural_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <set>

#include "calib/simulate/internal/beam.h"
#include "calib/simulate/internal/shading.h"
#include "tests/unit/simulate/simulate_testing.h"

namespace rgbdt::simulate {
namespace {

using Eigen::Vector3d;

Options Natural(std::uint64_t seed, Scene scene) {
  Options options = SmallOptions(scene);
  options.seed = seed;
  options.natural.on = true;
  return options;
}

World Shown(const Options& options, int index = 0) {
  return {std::make_shared<SceneModel>(MakeNaturalScene(options, index)), std::nullopt, options};
}

bool SamePlaces(const SceneObject& a, const SceneObject& b) {
  const auto& v = a.mesh.vertices;
  const auto& w = b.mesh.vertices;
  return a.name == b.name && v.size() == w.size() &&
         std::memcmp(v.data(), w.data(), v.size() * sizeof(Vector3d)) == 0;
}

Vector3d Towards(double azimuth_deg, double elevation_deg) {
  const double a = azimuth_deg * kDegree, e = elevation_deg * kDegree;
  return {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
}

Vector3d Centre(const Mesh& mesh) {
  Vector3d sum(0, 0, 0);
  for (const Vector3d& v : mesh.vertices) sum += v;
  return sum / static_cast<double>(mesh.vertices.size());
}

constexpr Scene kScenes[] = {Scene::kOutdoor, Scene::kIndoor};

TEST(NaturalScene, SeedAndViewGiveTheSameBits) {
  for (const Scene scene : kScenes) {
    const Options options = Natural(3, scene);
    const SceneModel first = MakeNaturalScene(options, 5);
    const SceneModel again = MakeNaturalScene(options, 5);
    ASSERT_EQ(first.objects.size(), again.objects.size());
    for (std::size_t i = 0; i < first.objects.size(); ++i) {
      EXPECT_TRUE(SamePlaces(first.objects[i], again.objects[i])) << first.objects[i].name;
      EXPECT_EQ(first.objects[i].material.temperature_k, again.objects[i].material.temperature_k);
      EXPECT_EQ(first.objects[i].material.albedo, again.objects[i].material.albedo);
    }
  }
}

TEST(NaturalScene, AnotherSeedIsAnotherPlace) {
  for (const Scene scene : kScenes) {
    const World first = Shown(Natural(1, scene));
    const World second = Shown(Natural(2, scene));
    int same = 0, count = 0;
    for (double azimuth = -40; azimuth <= 40; azimuth += 0.5) {
      for (const double elevation : {-3.0, 3.0}) {
        const double a = first.caster().Cast({0, 0, 0}, Towards(azimuth, elevation)).range;
        const double b = second.caster().Cast({0, 0, 0}, Towards(azimuth, elevation)).range;
        ++count;
        same += std::abs(a - b) < 0.02 ? 1 : 0;
      }
    }
    EXPECT_LT(same, count / 5);
  }
}

/// Edges in depth, from 3 to 12 m, over the field of view of the cameras.
TEST(NaturalScene, HasDepthEdgesNearBy) {
  for (const Scene scene : kScenes) {
    for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
      const World world = Shown(Natural(seed, scene));
      int edges = 0;
      for (double elevation = -20; elevation <= 15; elevation += 1) {
        double last = 0;
        for (double azimuth = -38; azimuth <= 38; azimuth += 0.1) {
          const double range = world.caster().Cast({0, 0, 0}, Towards(azimuth, elevation)).range;
          ASSERT_GT(range, 0.8);
          if (azimuth > -38 && std::min(range, last) < 12 && std::abs(range - last) > 0.3) ++edges;
          last = range;
        }
      }
      EXPECT_GT(edges, 150) << "seed " << seed;
    }
  }
}

/// Neighbouring rays onto one flat face at one range, of which one lies in the shadow.
TEST(NaturalScene, ShadowsAreEdgesInColourOnly) {
  for (const Scene scene : kScenes) {
    int shadows = 0;
    for (const std::uint64_t seed : {1, 2, 3}) {
      const World world = Shown(Natural(seed, scene));
      for (double elevation = -25; elevation <= 15; elevation += 2) {
        Seen last;
        for (double azimuth = -38; azimuth <= 38; azimuth += 0.05) {
          const Seen seen = SeeColor(world, {0, 0, 0}, Towards(azimuth, elevation), 1e-3);
          const bool same_face = seen.patch >> 32 == last.patch >> 32 && seen.patch != 0;
          const bool same_depth = std::abs(seen.range - last.range) < 0.02 * seen.range;
          const double step = (seen.value - last.value).norm();
          shadows += same_face && same_depth && step > 0.25 * seen.value.norm() &&
                             (seen.patch & 0xff) != (last.patch & 0xff)
                         ? 1
                         : 0;
          last = seen;
        }
      }
    }
    EXPECT_GT(shadows, 50);
  }
}

TEST(NaturalScene, WarmPatchesAreEdgesInHeatOnly) {
  for (const Scene scene : kScenes) {
    int edges = 0;
    for (const std::uint64_t seed : {1, 2, 3}) {
      const World world = Shown(Natural(seed, scene));
      for (double elevation = -25; elevation <= -5; elevation += 1) {
        Seen last;
        for (double azimuth = -38; azimuth <= 38; azimuth += 0.05) {
          const Seen seen = SeeHeat(world, {0, 0, 0}, Towards(azimuth, elevation), 1e-3);
          const bool same_depth = std::abs(seen.range - last.range) < 0.01 * seen.range;
          edges += same_depth && std::abs(seen.value[0] - last.value[0]) > 1 ? 1 : 0;
          last = seen;
        }
      }
    }
    EXPECT_GT(edges, 20);
  }
}

TEST(NaturalScene, GlassReturnsNothingAndMirrorsTheSky) {
  const Options options = Natural(1, Scene::kOutdoor);
  const World world = Shown(options);
  int panes = 0, bright = 0;
  for (const SceneObject& object : world.scene().objects) {
    if (object.name != "glass") continue;
    const Vector3d place = object.mesh.vertices[0] * 0.8 + object.mesh.vertices[2] * 0.2;
    const Vector3d direction = place.normalized();
    const Hit hit = world.caster().Cast({0, 0, 0}, direction);
    if (!hit.hit() || std::abs(hit.range - place.norm()) > 0.01 || place.norm() > 25) continue;
    ++panes;
    EXPECT_EQ(world.Reflectivity(hit, place), 0);
    BeamReturn back;
    CastBeams(world, options.scanner, {0, 0, 0}, {direction}, 1, &back);
    EXPECT_TRUE(std::isnan(back.range));
    bright += SeeColor(world, {0, 0, 0}, direction, 1e-3).value.maxCoeff() > 0.1 ? 1 : 0;
  }
  EXPECT_GT(panes, 5);
  EXPECT_GT(bright, 2);
}

std::vector<const SceneObject*> Named(const SceneModel& scene, const std::set<std::string>& names) {
  std::vector<const SceneObject*> found;
  for (const SceneObject& object : scene.objects) {
    if (names.count(object.name) > 0) found.push_back(&object);
  }
  return found;
}

TEST(NaturalScene, WalkersAloneMoveWhileTheRigStands) {
  for (const Scene scene : kScenes) {
    Options options = Natural(2, scene);
    options.natural.step_m = 0;
    const SceneModel first = MakeNaturalScene(options, 0);
    const SceneModel second = MakeNaturalScene(options, 1);
    const std::set<std::string> of_people{"limb", "torso", "head", "hair", "hand", "shoe", "neck"};
    std::size_t still = 0;
    while (of_people.count(first.objects[still].name) == 0) {
      ASSERT_TRUE(SamePlaces(first.objects[still], second.objects[still]));
      ++still;
    }
    const auto before = Named(first, {"head"}), after = Named(second, {"head"});
    ASSERT_GE(before.size(), 2U);
    ASSERT_GE(after.size(), 2U);
    EXPECT_GT((Centre(before[0]->mesh) - Centre(after[0]->mesh)).norm(), 0.1);
    options.natural.people = 0;
    EXPECT_TRUE(Named(MakeNaturalScene(options, 0), of_people).empty());
  }
}

/// The rig moves, things stay: in the world's frame they are where they were.
TEST(NaturalScene, ThingsStayWhereTheyAreAsTheRigDrives) {
  for (const Scene scene : kScenes) {
    const Options options = Natural(1, scene);
    const SceneModel first = MakeNaturalScene(options, 1);
    const SceneModel second = MakeNaturalScene(options, 4);
    const std::set<std::string> names{"car body", "cupboard", "table top"};
    const auto before = Named(first, names), after = Named(second, names);
    ASSERT_FALSE(before.empty());
    int same = 0;
    for (const SceneObject* object : before) {
      EXPECT_GT(
          (*first.world_from_lidar * object->mesh.vertices[0] - object->mesh.vertices[0]).norm(),
          0.1);
      for (const SceneObject* other : after) {
        const Vector3d a = *first.world_from_lidar * Centre(object->mesh);
        const Vector3d b = *second.world_from_lidar * Centre(other->mesh);
        same += (a - b).norm() < 1e-9 ? 1 : 0;
      }
    }
    EXPECT_GE(same, static_cast<int>(before.size()) - 4);  // far ones come into reach
  }
}

TEST(NaturalScene, SunShinesFromAnotherSideWithAnotherSeed) {
  Options options = Natural(1, Scene::kOutdoor);
  options.natural.step_m = 0;
  const Vector3d first = MakeNaturalScene(options, 0).lights[0].place;
  options.seed = 2;
  const Vector3d second = MakeNaturalScene(options, 0).lights[0].place;
  EXPECT_NEAR(first.norm(), 1, 1e-12);
  EXPECT_GT((first - second).norm(), 0.05);
}

}  // namespace
}  // namespace rgbdt::simulate
