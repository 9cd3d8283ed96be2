#include "calib/simulate/internal/scene.h"

#include "calib/simulate/internal/clutter.h"
#include "calib/simulate/internal/natural_scene.h"
#include "calib/simulate/internal/people.h"
#include "calib/simulate/internal/things.h"

namespace rgbdt::simulate {
namespace {

using Eigen::Vector3d;

void AddTree(double x, double y, double ground, double height, double temperature,
             SceneModel* scene) {
  const Material bark =
      Paint(Rgb(0.16, 0.11, 0.07), 0.35, temperature, {Texture::Kind::kBlotches, 0.08, 0.5, 0.3});
  const Material leaves = Paint(Rgb(0.10, 0.22, 0.05), 0.5, temperature - 1.5,
                                {Texture::Kind::kBlotches, 0.25, 0.7, 0.5});
  const double trunk = 0.45 * height;
  scene->objects.push_back(
      {"trunk", MakeRod({x, y, ground - 0.05}, {x, y, ground + trunk + 0.4}, 0.16, 0.1), bark});
  const std::vector<Vector3d> crowns{
      {0, 0, 0.72}, {0.1, 0.16, 0.6}, {-0.06, -0.17, 0.62}, {-0.05, 0.03, 0.86}};
  for (const Vector3d& c : crowns) {
    const double radius = 0.2 * height * (c.z() > 0.8 ? 0.75 : 1);
    scene->objects.push_back(
        {"crown",
         MakeEllipsoid({x + c.x() * height, y + c.y() * height, ground + c.z() * height},
                       {radius, radius, 0.8 * radius}),
         leaves});
  }
}

/// Ground, a brick building, trees, crates, a lamp post, a car-sized container and a person.
/// `warm` [K] is how much the sun heats what it shines on.
void AddYard(double ground, double air, double warm, double person, SceneModel* scene) {
  const auto add = [&](const char* name, const Mesh& mesh, const Material& material) {
    scene->objects.push_back({name, mesh, material});
  };
  add("lawn", MakeQuad({-60, -60, ground}, {80, -60, ground}, {80, 60, ground}, {-60, 60, ground}),
      Paint(Rgb(0.13, 0.20, 0.06), 0.45, air + 0.3 * warm,
            {Texture::Kind::kBlotches, 0.35, 0.5, 0.8}));
  add("pavement",
      MakeQuad({-3, -4.2, ground + 0.01}, {13.5, -4.2, ground + 0.01}, {13.5, 4.2, ground + 0.01},
               {-3, 4.2, ground + 0.01}),
      Paint(Rgb(0.30, 0.29, 0.27), 0.3, air + 0.8 * warm, {Texture::Kind::kTiles, 0.6, 0.18, 0.3}));
  add("building", MakeBox({14, -14, ground - 0.1}, {22, 2.6, ground + 4.6}),
      Paint(Rgb(0.42, 0.17, 0.11), 0.4, air + 0.6 * warm,
            {Texture::Kind::kBricks, 0.45, 0.45, 0.3}));
  add("roof edge", MakeBox({13.8, -14.1, ground + 4.6}, {22, 2.8, ground + 4.85}),
      Paint(Rgb(0.62, 0.60, 0.56), 0.6, air + 0.7 * warm));
  for (const double y : {-1.6, -5.2, -8.8}) {
    add("window", MakeBox({13.93, y - 0.7, ground + 1.5}, {14.02, y + 0.7, ground + 3.1}),
        Paint(Rgb(0.06, 0.10, 0.14), 0.06, air - 2));
    add("frame", MakeBox({13.9, y - 0.8, ground + 1.38}, {14.01, y + 0.8, ground + 1.5}),
        Paint(Rgb(0.7, 0.7, 0.68), 0.7, air + 0.5 * warm));
  }
  add("door", MakeBox({13.94, 0.4, ground}, {14.02, 1.5, ground + 2.2}),
      Paint(Rgb(0.08, 0.24, 0.34), 0.35, air + 0.9 * warm));
  add("container", MakeBox({11.5, 4.8, ground}, {14.5, 9.5, ground + 2.4}),
      Paint(Rgb(0.10, 0.26, 0.45), 0.4, air + warm, {Texture::Kind::kPlanks, 0.2, 0.25, 0.3}));
  const Texture wood{Texture::Kind::kPlanks, 0.12, 0.35, 0.3};
  add("crate", MakeBox({7.6, -2.9, ground}, {8.3, -2.2, ground + 0.7}),
      Paint(Rgb(0.52, 0.36, 0.18), 0.55, air + 0.7 * warm, wood));
  add("crate", MakeBox({7.8, -2.1, ground}, {8.5, -1.5, ground + 0.55}),
      Paint(Rgb(0.60, 0.44, 0.24), 0.6, air + 0.6 * warm, wood));
  add("crate", MakeBox({7.75, -2.75, ground + 0.7}, {8.2, -2.3, ground + 1.1}),
      Paint(Rgb(0.75, 0.55, 0.05), 0.65, air + 0.9 * warm));
  add("barrel", MakeRod({9.2, 1.2, ground}, {9.2, 1.2, ground + 0.9}, 0.3, 0.3),
      Paint(Rgb(0.08, 0.30, 0.14), 0.3, air + 1.1 * warm));
  add("post", MakeRod({10.5, 3.6, ground}, {10.5, 3.6, ground + 4.2}, 0.07, 0.05),
      Paint(Rgb(0.35, 0.36, 0.37), 0.4, air + 0.6 * warm));
  AddTree(12.5, -4.9, ground, 4.6, air, scene);
  AddTree(17, 5.5, ground, 6.5, air, scene);
  AddTree(9.5, 6.9, ground, 4.2, air, scene);
  AddPerson(7.6, 2.6, ground, person, &scene->objects);
}

/// A laboratory: walls, bench, shelf, cupboard, screens, a heater and a person.
void AddRoom(double ground, double air, double person, SceneModel* scene) {
  const double top = ground + 3.5;
  const double x0 = -2, x1 = 8.4, y0 = -4.4, y1 = 4.4;
  const auto add = [&](const char* name, const Mesh& mesh, const Material& material) {
    scene->objects.push_back({name, mesh, material});
  };
  add("floor", MakeQuad({x0, y0, ground}, {x1, y0, ground}, {x1, y1, ground}, {x0, y1, ground}),
      Paint(Rgb(0.33, 0.31, 0.28), 0.35, air - 1.2, {Texture::Kind::kTiles, 0.5, 0.15, 0.15}));
  add("ceiling", MakeQuad({x0, y0, top}, {x1, y0, top}, {x1, y1, top}, {x0, y1, top}),
      Paint(Rgb(0.75, 0.75, 0.73), 0.75, air + 1.2));
  const Texture plaster{Texture::Kind::kBlotches, 0.9, 0.05, 0.3};
  add("back wall", MakeQuad({x1, y0, ground}, {x1, y1, ground}, {x1, y1, top}, {x1, y0, top}),
      Paint(Rgb(0.55, 0.60, 0.58), 0.65, air, plaster));
  add("left wall", MakeQuad({x0, y1, ground}, {x1, y1, ground}, {x1, y1, top}, {x0, y1, top}),
      Paint(Rgb(0.66, 0.60, 0.46), 0.65, air - 0.3, plaster));
  add("right wall", MakeQuad({x0, y0, ground}, {x1, y0, ground}, {x1, y0, top}, {x0, y0, top}),
      Paint(Rgb(0.66, 0.60, 0.46), 0.65, air - 0.6, plaster));
  add("rear wall", MakeQuad({x0, y0, ground}, {x0, y1, ground}, {x0, y1, top}, {x0, y0, top}),
      Paint(Rgb(0.6, 0.6, 0.6), 0.65, air));
  add("door", MakeBox({8.33, 1.9, ground}, {8.4, 2.9, ground + 2.1}),
      Paint(Rgb(0.40, 0.22, 0.10), 0.45, air - 0.3, {Texture::Kind::kPlanks, 0.25, 0.15, 0}));
  add("poster", MakeBox({8.37, -0.2, ground + 1.4}, {8.4, 1.2, ground + 2.4}),
      Paint(Rgb(0.08, 0.22, 0.45), 0.4, air + 0.2, {Texture::Kind::kTiles, 0.2, 0.5, 0}));
  add("bench top", MakeBox({7.2, -1.5, ground + 0.86}, {8.3, 1.4, ground + 0.92}),
      Paint(Rgb(0.50, 0.36, 0.20), 0.5, air, {Texture::Kind::kPlanks, 0.15, 0.2, 0}));
  for (const double y : {-1.4, 1.3}) {
    add("bench leg", MakeBox({7.3, y - 0.04, ground}, {7.38, y + 0.04, ground + 0.86}),
        Paint(Rgb(0.25, 0.25, 0.27), 0.35, air - 0.5));
  }
  for (const double y : {-0.75, 0.05}) {
    add("screen", MakeBox({7.7, y - 0.32, ground + 1.05}, {7.76, y + 0.32, ground + 1.42}),
        Paint(Rgb(0.03, 0.03, 0.035), 0.08, air + 7));
    add("screen foot", MakeBox({7.72, y - 0.04, ground + 0.92}, {7.75, y + 0.04, ground + 1.05}),
        Paint(Rgb(0.1, 0.1, 0.1), 0.15, air + 1));
  }
  add("box", MakeBox({7.4, 0.6, ground + 0.92}, {7.8, 1.1, ground + 1.22}),
      Paint(Rgb(0.58, 0.42, 0.25), 0.55, air));
  add("box", MakeBox({6.9, -0.6, ground}, {7.4, 0.0, ground + 0.45}),
      Paint(Rgb(0.62, 0.12, 0.08), 0.5, air - 0.5));
  add("cupboard", MakeBox({7.5, -4.3, ground}, {8.35, -3.1, ground + 2.0}),
      Paint(Rgb(0.22, 0.33, 0.42), 0.45, air - 0.4));
  add("heater", MakeBox({7.6, 3.2, ground + 0.15}, {8.3, 4.2, ground + 0.8}),
      Paint(Rgb(0.7, 0.7, 0.68), 0.7, air + 14));
  add("shelf", MakeBox({3.4, 3.9, ground}, {5.6, 4.35, ground + 2.2}),
      Paint(Rgb(0.45, 0.30, 0.16), 0.5, air, {Texture::Kind::kPlanks, 0.3, 0.4, 0}));
  AddPerson(7.0, -2.35, ground, person, &scene->objects);
}

void AddDaylight(SceneModel* scene) {
  Light sun;  // behind the rig, so that the board's face is lit
  sun.place = Vector3d(-0.78, 0.36, 0.55).normalized();
  sun.color = Rgb(0.78, 0.75, 0.68);
  scene->lights.push_back(sun);
  scene->ambient = Rgb(0.24, 0.28, 0.35);
  scene->sky.zenith = Rgb(0.14, 0.28, 0.52);
  scene->sky.horizon = Rgb(0.44, 0.52, 0.60);
  scene->sky.cloud = 0.25;
  scene->sky.zenith_k = 242;
  scene->sky.horizon_k = 272;
}

void AddRoomLight(double ground, SceneModel* scene) {
  for (const Vector3d& place : {Vector3d(0.2, 1.6, 3.3), Vector3d(0.2, -1.6, 3.3),
                                Vector3d(4.6, 1.6, 3.3), Vector3d(4.6, -1.6, 3.3)}) {
    Light light;
    light.kind = Light::Kind::kPoint;
    light.place = place + Vector3d(0, 0, ground);
    light.color = Rgb(0.30, 0.285, 0.25);
    light.reach_m = 3;
    light.casts_shadows = place.x() < 2;
    scene->lights.push_back(light);
  }
  scene->ambient = Rgb(0.30, 0.29, 0.28);
}

void AddLamp(double range, SceneModel* scene) {
  Light lamp;
  lamp.kind = Light::Kind::kLamp;
  lamp.place = {0.0, 0.15, 0.25};
  lamp.color = Rgb(0.95, 0.95, 1.0);
  lamp.reach_m = 3;
  lamp.cone_rad = 36 * kDegree;
  lamp.end_m = range;
  scene->lights.push_back(lamp);
  scene->ambient = Rgb(0.0007, 0.0008, 0.0014);
  scene->sky.zenith = Rgb(0.0006, 0.0008, 0.0018);
  scene->sky.horizon = Rgb(0.002, 0.002, 0.003);
  scene->sky.zenith_k = 236;
  scene->sky.horizon_k = 262;
}

}  // namespace

SceneModel MakeScene(const Options& options) {
  if (options.natural.on) return MakeNaturalScene(options, 0);
  const double ground = options.world.ground_z_m;
  const double person = options.world.person_temperature_k;
  SceneModel scene;
  switch (options.scene) {
    case Scene::kOutdoor:
      scene.air_k = 297;
      scene.reflected_temperature_k = 275;
      scene.board_heat = {307, 6, 4, 3};
      AddYard(ground, scene.air_k, 6, person, &scene);
      AddDaylight(&scene);
      break;
    case Scene::kIndoor:
      scene.air_k = 294;
      scene.reflected_temperature_k = 294;
      scene.board_heat = {299, 3, 1.5, 1.2};
      AddRoom(ground, scene.air_k, person, &scene);
      AddRoomLight(ground, &scene);
      break;
    case Scene::kNight:
      scene.air_k = 281;
      scene.reflected_temperature_k = 262;
      scene.board_heat = {288, 2.5, 1.5, 1.2};
      AddYard(ground, scene.air_k, 2, person, &scene);
      AddLamp(options.world.lamp_range_m, &scene);
      break;
  }
  if (options.world.reflected_temperature_k != 0) {
    scene.reflected_temperature_k = options.world.reflected_temperature_k;
  }
  AddClutter(options, &scene);
  return scene;
}

}  // namespace rgbdt::simulate
