#include "calib/simulate/internal/natural_scene.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/simulate/internal/drive.h"
#include "calib/simulate/internal/room.h"
#include "calib/simulate/internal/street.h"
#include "calib/simulate/internal/walker.h"

namespace rgbdt::simulate {
namespace {

using Eigen::Vector3d;

void AddSunAndSky(const Options& options, SceneModel* scene) {
  Dice draw(options.seed, 0, "weather");
  Light sun;
  const double azimuth = draw.Between(0, 2 * M_PI);
  const double elevation = draw.Between(28, 58) * kDegree;
  const auto towards = [&](double turn) {
    return Vector3d(std::cos(elevation) * std::cos(azimuth + turn),
                    std::cos(elevation) * std::sin(azimuth + turn), std::sin(elevation));
  };
  sun.place = towards(0);
  sun.color = Rgb(0.86, 0.80, 0.70);
  scene->lights.push_back(sun);
  scene->warming_sun = towards(-3 * kDegree);  // a quarter of an hour ago
  scene->ambient = Rgb(0.29, 0.33, 0.40);
  scene->sky.zenith = Rgb(0.14, 0.28, 0.52);
  scene->sky.horizon = Rgb(0.44, 0.52, 0.60);
  scene->sky.cloud = draw.Between(0.05, 0.35);
  scene->sky.zenith_k = 242;
  scene->sky.horizon_k = 272;
}

void MakeOutdoors(const Options& options, double x_m, SceneModel* scene) {
  scene->air_k = 297;
  scene->reflected_temperature_k = 275;
  scene->board_heat = {307, 6, 4, 3};
  scene->white = 0.45;
  scene->objects = MakeStreet(options, {297, 9}, x_m).parts();
  AddSunAndSky(options, scene);
}

void MakeIndoors(const Options& options, SceneModel* scene) {
  scene->air_k = scene->reflected_temperature_k = 294;
  scene->board_heat = {299, 3, 1.5, 1.2};
  scene->white = 0.42;
  scene->objects = MakeRoom(options, {294, 0}, &scene->lights).parts();
  scene->ambient = Rgb(0.26, 0.25, 0.24);
  // What windows show.
  scene->sky.zenith = Rgb(0.3, 0.45, 0.7);
  scene->sky.horizon = Rgb(0.8, 0.85, 0.9);
}

/// Whether a column of this radius [m] and a person's height meets nothing.
bool IsFree(const std::vector<Bounds>& bounds, double x, double y, double ground) {
  constexpr double kRadius = 0.4;
  return std::none_of(bounds.begin(), bounds.end(), [&](const Bounds& e) {
    return e.low.z() < ground + 1.9 && e.high.z() > ground + 0.12 && e.low.x() - kRadius < x &&
           e.high.x() + kRadius > x && e.low.y() - kRadius < y && e.high.y() + kRadius > y;
  });
}

Bounds Inside(const Options& options, const std::vector<Bounds>& bounds) {
  if (options.scene != Scene::kIndoor) return {{-1e9, -1e9, 0}, {1e9, 1e9, 0}};
  Bounds room = bounds.front();  // the floor
  room.low.array() += 0.5;
  room.high.array() -= 0.5;
  return room;
}

/// People on the free ground before the rig, each view elsewhere. World frame.
void AddWalkers(const Options& options, const Rigid3& world_from_lidar, int index,
                std::vector<SceneObject>* objects) {
  std::vector<Bounds> bounds;
  for (const SceneObject& object : *objects) bounds.push_back(BoundsOf(object.mesh));
  const double ground = options.world.ground_z_m;
  const bool outdoors = options.scene != Scene::kIndoor;
  const Bounds inside = Inside(options, bounds);
  for (int person = 0; person < options.natural.people; ++person) {
    Dice draw(options.seed, index, "walker " + std::to_string(person));
    for (int attempt = 0; attempt < 200; ++attempt) {
      // Every other one walks near by.
      const double range = draw.Between(2.8, person % 2 == 0 || !outdoors ? 6 : 16);
      const double azimuth = draw.Between(-38, 38) * kDegree;
      // Where the board has to find a place.
      if (options.natural.board && range < 7 && std::abs(azimuth) < 17 * kDegree) continue;
      const Vector3d place =
          world_from_lidar * Vector3d(range * std::cos(azimuth), range * std::sin(azimuth), 0);
      if (place.x() < inside.low.x() || place.x() > inside.high.x() || place.y() < inside.low.y() ||
          place.y() > inside.high.y() || !IsFree(bounds, place.x(), place.y(), ground)) {
        continue;
      }
      const Rigid3 feet = Standing(place.x(), place.y(), ground + 0.02, draw.Between(-M_PI, M_PI));
      Thing walker(Warmth{});
      walker.AddAll(feet, MakeWalker(&draw, options.world.person_temperature_k));
      for (const SceneObject& part : walker.parts()) {
        bounds.push_back(BoundsOf(part.mesh));
        objects->push_back(part);
      }
      break;
    }
  }
}

/// Takes a scene that is in the world's frame into the LIDAR's.
void MoveIntoLidar(const Rigid3& world_from_lidar, SceneModel* scene) {
  const Rigid3 lidar_from_world = world_from_lidar.Inverse();
  for (SceneObject& object : scene->objects) {
    object.mesh = Transformed(lidar_from_world, std::move(object.mesh));
  }
  for (Light& light : scene->lights) {
    light.place = light.kind == Light::Kind::kSun ? lidar_from_world.rotation * light.place
                                                  : lidar_from_world * light.place;
  }
  scene->warming_sun = lidar_from_world.rotation * scene->warming_sun;
  scene->world_from_lidar = world_from_lidar;
}

}  // namespace

SceneModel MakeNaturalWorld(const Options& options, double x_m) {
  SceneModel scene;
  if (options.scene == Scene::kIndoor) {
    MakeIndoors(options, &scene);
  } else {
    MakeOutdoors(options, x_m, &scene);
  }
  if (options.world.reflected_temperature_k != 0) {
    scene.reflected_temperature_k = options.world.reflected_temperature_k;
  }
  scene.many_edges = true;
  scene.world_from_lidar = Rigid3();
  return scene;
}

SceneModel MakeNaturalScene(const Options& options, int index) {
  const Rigid3 world_from_lidar = WorldFromLidar(options, index);
  SceneModel scene = MakeNaturalWorld(options, world_from_lidar.translation.x());
  AddWalkers(options, world_from_lidar, index, &scene.objects);
  MoveIntoLidar(world_from_lidar, &scene);
  return scene;
}

}  // namespace rgbdt::simulate
