#include "calib/simulate/internal/clutter.h"

#include <array>
#include <cmath>
#include <utility>

#include "calib/model/errors.h"
#include "calib/simulate/internal/board.h"
#include "calib/simulate/internal/noise.h"
#include "calib/simulate/internal/option_checks.h"
#include "calib/simulate/internal/ray_caster.h"

namespace rgbdt::simulate {
namespace {

using Eigen::Vector3d;

constexpr double kWallHeight = 2.4;
constexpr double kGap = 0.15;           ///< between things [m]
constexpr double kFree = 17 * kDegree;  ///< a board at medium range, to either side of its middle

Material Grey(double reflectivity) {
  Material material;
  material.albedo.setConstant(reflectivity);
  material.reflectivity = reflectivity;
  return material;
}

/// A wall of this width whose face is x = 0.
SceneObject Wall(double width) {
  return {"clutter wall", MakeBox({0, -0.5 * width, 0}, {0.1, 0.5 * width, kWallHeight}),
          Grey(0.6)};
}

/// An upright rectangle in x = 0, its middle at this height.
std::vector<Vector3d> Corners(const Eigen::Vector2d& size, double middle) {
  std::vector<Vector3d> corners{{0, 0, middle}};
  for (const double y : {-0.45, 0.45}) {
    for (const double z : {-0.45, 0.45})
      corners.emplace_back(0, y * size.x(), middle + z * size.y());
  }
  return corners;
}

struct Box {
  Vector3d low, high;
};

Box BoxOf(const Mesh& mesh) {
  Box box{mesh.vertices[0], mesh.vertices[0]};
  for (const Vector3d& vertex : mesh.vertices) {
    box.low = box.low.cwiseMin(vertex);
    box.high = box.high.cwiseMax(vertex);
  }
  return box;
}

bool Near(const Box& a, const Box& b) {
  return ((a.low.array() - kGap) < b.high.array()).all() &&
         ((b.low.array() - kGap) < a.high.array()).all();
}

/// Whether the parts come near anything but the ground.
bool Touches(const std::vector<SceneObject>& parts, const SceneModel& scene, double ground) {
  for (const SceneObject& object : scene.objects) {
    const Box box = BoxOf(object.mesh);
    if (box.high.z() < ground + 0.03) continue;
    for (const SceneObject& part : parts) {
      if (Near(BoxOf(part.mesh), box)) return true;
    }
  }
  return false;
}

/// Whether the parts stand straight ahead, and not well behind a board at medium range: the board
/// must find a place there.
bool InTheWay(const std::vector<SceneObject>& parts, const PoseOptions& pose) {
  double left = -180 * kDegree, right = -left, nearest = 1e9;
  for (const SceneObject& part : parts) {
    for (const Vector3d& vertex : part.mesh.vertices) {
      const double azimuth = std::atan2(vertex.y(), vertex.x());
      left = std::max(left, azimuth);
      right = std::min(right, azimuth);
      nearest = std::min(nearest, vertex.head<2>().norm());
    }
  }
  const double medium = pose.min_range_m + 0.4 * (pose.max_range_m - pose.min_range_m);
  return left > -kFree && right < kFree && nearest < medium + 1.5;
}

RayCaster CasterOf(const std::vector<SceneObject>& objects) {
  std::vector<Mesh> meshes;
  meshes.reserve(objects.size());
  for (const SceneObject& object : objects) meshes.push_back(object.mesh);
  return RayCaster(meshes);
}

/// Whether the LIDAR sees all the places past what the caster holds.
bool AllSeen(const RayCaster& caster, const std::vector<Vector3d>& places) {
  for (const Vector3d& place : places) {
    const double range = place.norm();
    if (caster.Blocked(Vector3d::Zero(), place / range, range - 0.01)) return false;
  }
  return true;
}

/// lidar_from_thing of an attempt.
Rigid3 DrawPlace(const Options& options, const std::string& name, int attempt) {
  const ClutterOptions& o = options.clutter;
  const Noise noise(options.seed, attempt, "clutter " + name);
  const double side = noise.Uniform(0) < 0.5 ? -1 : 1;
  const double azimuth = side * noise.Uniform(1, o.min_azimuth_rad, o.max_azimuth_rad);
  const double range = noise.Uniform(2, o.near_m, o.far_m);
  const double turn = noise.Uniform(3, -25 * kDegree, 25 * kDegree);
  Rigid3 place = RotationAbout(Vector3d::UnitZ(), azimuth + turn);
  place.translation = {range * std::cos(azimuth), range * std::sin(azimuth),
                       options.world.ground_z_m};
  return place;
}

ClutterThing Moved(const Rigid3& lidar_from_thing, ClutterThing thing) {
  for (SceneObject& part : thing.parts) part.mesh = Transformed(lidar_from_thing, part.mesh);
  for (Vector3d& place : thing.seen) place = lidar_from_thing * place;
  return thing;
}

/// The second board: leaning, turned and heated as seed and place draw.
ClutterThing MakeSecondBoard(const Options& options, const SceneModel& scene,
                             const Rigid3& lidar_from_thing) {
  const Noise noise(options.seed, 0, "clutter pose of the second board");
  Eigen::Matrix3d axes;  // columns: target's x, y, z in the thing's frame, upright
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  Rigid3 thing_from_target;
  thing_from_target.rotation =
      Eigen::Quaterniond(axes) *
      RotationAbout(Vector3d::UnitX(), noise.Uniform(0, -20 * kDegree, 20 * kDegree)).rotation *
      RotationAbout(Vector3d::UnitZ(), noise.Uniform(1, -20 * kDegree, 20 * kDegree)).rotation;
  thing_from_target.translation = {0, 0, 1.2};
  const HeatMap heat = DrawHeat(options.board, scene.board_heat, options.seed, -1);
  const auto board =
      std::make_shared<Board>(options.board, lidar_from_thing * thing_from_target, heat);
  ClutterThing thing;
  thing.parts.push_back({"second board", board->Shape(), {}, board});
  Material stand = Grey(options.board.stand_reflectivity);
  for (const Mesh& part : board->Stand(options.world.ground_z_m)) {
    thing.parts.push_back({"second stand", part, stand});
  }
  for (const Vector3d& corner : MakeTarget(options.board).OutlineCorners()) {
    thing.seen.push_back(board->lidar_from_target() * Vector3d(0.95 * corner));
  }
  return thing;
}

/// Puts a thing where there is room. `make` gives it in the LIDAR frame. `seen` grows: nothing that
/// comes later may hide what came before.
template <typename Make>
void Put(const Options& options, const std::string& name, const Make& make, SceneModel* scene,
         std::vector<Vector3d>* seen) {
  constexpr int kAttempts = 2000;
  const RayCaster before = CasterOf(scene->objects);
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const ClutterThing thing = make(DrawPlace(options, name, attempt));
    if (InTheWay(thing.parts, options.pose) || !AllSeen(before, thing.seen) ||
        Touches(thing.parts, *scene, options.world.ground_z_m)) {
      continue;
    }
    const RayCaster added = CasterOf(thing.parts);
    if (!AllSeen(added, *seen) || !AllSeen(added, thing.seen)) continue;
    for (SceneObject part : thing.parts) {
      part.material.temperature_k = scene->air_k;
      scene->objects.push_back(std::move(part));
    }
    seen->insert(seen->end(), thing.seen.begin(), thing.seen.end());
    return;
  }
  throw InputError("simulator: no room for the " + name +
                   "; give clutter.near_m to far_m and its azimuths more, or ask for fewer things");
}

}  // namespace

void ClutterOptions::Check() const {
  const std::array<std::pair<const char*, Eigen::Vector2d>, 4> sizes{
      {{"clutter.door_m", door_m},
       {"clutter.poster_m", poster_m},
       {"clutter.table_m", table_m},
       {"clutter.panel_m", panel_m}}};
  for (const auto& [field, size] : sizes) {
    kCheck.Between(size.x(), 0.1, 3, field);
    kCheck.Between(size.y(), 0.1, 2.3, field);
  }
  kCheck.Between(table_height_m, 0.2, 1.5, "clutter.table_height_m");
  kCheck.Between(door_ajar_rad, 0, 90 * kDegree, "clutter.door_ajar_rad");
  kCheck.Between(near_m, 1, 100, "clutter.near_m");
  kCheck.Between(far_m, near_m, 100, "clutter.far_m");
  kCheck.Between(min_azimuth_rad, 0, 180 * kDegree, "clutter.min_azimuth_rad");
  kCheck.Between(max_azimuth_rad, min_azimuth_rad, 180 * kDegree, "clutter.max_azimuth_rad");
}

ClutterThing MakeDoor(const ClutterOptions& options) {
  const double width = options.door_m.x();
  const double height = options.door_m.y();
  Rigid3 hinge = RotationAbout(Vector3d::UnitZ(), options.door_ajar_rad);
  hinge.translation = {-0.05, -0.5 * width, 0.02};  // the leaf opens towards the LIDAR
  ClutterThing thing{"door", {Wall(width + 1)}, {}};
  const Mesh leaf = Transformed(hinge, MakeBox({-0.04, 0, 0}, {0, width, height}));
  thing.parts.push_back({"door leaf", leaf, Grey(0.45)});
  for (const double y : {0.05, 0.95}) {
    for (const double z : {0.05, 0.95}) {
      thing.seen.push_back(hinge * Vector3d(-0.04, y * width, z * height));
    }
  }
  return thing;
}

ClutterThing MakePoster(const ClutterOptions& options) {
  const double middle = 1.4;
  const Eigen::Vector2d half = 0.5 * options.poster_m;
  // Paper: a millimetre thick.
  const Mesh sheet =
      MakeBox({-0.001, -half.x(), middle - half.y()}, {0, half.x(), middle + half.y()});
  return {"poster",
          {Wall(options.poster_m.x() + 1), {"poster", sheet, Grey(0.25)}},
          Corners(options.poster_m, middle)};
}

ClutterThing MakeTable(const ClutterOptions& options) {
  const double depth = options.table_m.y();
  const double half = 0.5 * options.table_m.x();
  const double top = options.table_height_m;
  ClutterThing thing{"table", {}, {}};
  thing.parts.push_back(
      {"table top", MakeBox({0, -half, top - 0.03}, {depth, half, top}), Grey(0.5)});
  for (const double x : {0.05, depth - 0.05}) {
    for (const double y : {0.05 - half, half - 0.05}) {
      thing.parts.push_back(
          {"table leg", MakeRod({x, y, 0}, {x, y, top - 0.03}, 0.025, 0.025), Grey(0.35)});
      thing.seen.emplace_back(x, y, top);
    }
  }
  return thing;
}

ClutterThing MakePanel(const ClutterOptions& options) {
  const double middle = 1.3;
  const Eigen::Vector2d half = 0.5 * options.panel_m;
  const Mesh sheet =
      MakeBox({0, -half.x(), middle - half.y()}, {0.02, half.x(), middle + half.y()});
  return {"panel",
          {{"panel", sheet, Grey(0.75)},
           {"panel pole", MakeBox({0.03, -0.02, 0}, {0.07, 0.02, middle}), Grey(0.3)},
           {"panel foot", MakeRod({0.05, 0, 0}, {0.05, 0, 0.04}, 0.22, 0.2), Grey(0.3)}},
          Corners(options.panel_m, middle)};
}

void AddClutter(const Options& options, SceneModel* scene) {
  const ClutterOptions& o = options.clutter;
  std::vector<Vector3d> seen;
  const auto put = [&](bool wanted, const ClutterThing& thing) {
    if (!wanted) return;
    const auto make = [&](const Rigid3& lidar_from_thing) {
      return Moved(lidar_from_thing, thing);
    };
    Put(options, thing.name, make, scene, &seen);
  };
  // The largest first, while there is room.
  put(o.door, MakeDoor(o));
  put(o.poster, MakePoster(o));
  put(o.table, MakeTable(o));
  put(o.panel, MakePanel(o));
  if (!o.second_board) return;
  const auto make = [&](const Rigid3& place) { return MakeSecondBoard(options, *scene, place); };
  Put(options, "second board", make, scene, &seen);
}

}  // namespace rgbdt::simulate
