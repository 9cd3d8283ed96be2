#include "calib/simulate/internal/people.h"

#include <algorithm>

namespace rgbdt::simulate {
namespace {

using Eigen::Vector3d;

Material Cloth(double red, double green, double blue, double reflectivity, double temperature_k) {
  Material material;
  material.albedo = {blue, green, red};
  material.reflectivity = reflectivity;
  material.temperature_k = temperature_k;
  return material;
}

Material Skin(double temperature_k) { return Cloth(0.55, 0.33, 0.24, 0.5, temperature_k); }

/// Fingers over the front of the board, a palm round its side, a forearm that leads away from it.
/// `place` on the outline, target frame; `outwards` from there, along x or y.
void AddHand(const HolderOptions& holder, const Vector3d& place, const Vector3d& outwards,
             const Rigid3& lidar_from_target, std::vector<SceneObject>* objects) {
  const Material skin = Skin(holder.hand_k);
  const auto add = [&](const char* name, const Mesh& mesh) {
    objects->push_back({name, Transformed(lidar_from_target, mesh), skin});
  };
  const Vector3d along = Vector3d::UnitZ().cross(outwards);
  const Vector3d front(0, 0, -0.012);  // fingers lie on the board
  for (int i = 0; i < 4; ++i) {
    const Vector3d knuckle = place + (i - 1.5) * 0.021 * along + front;
    add("finger", MakeRod(knuckle + 0.03 * outwards, knuckle - holder.hand_reach_m * outwards,
                          0.0095, 0.008));
  }
  const Vector3d palm = place + 0.04 * outwards;
  add("palm", MakeEllipsoid(palm, {0.045, 0.045, 0.03}));
  add("forearm", MakeRod(palm, palm + 0.25 * outwards + Vector3d(0, 0, 0.15), 0.034, 0.042));
}

/// How far [m] the board reaches from its centre in a direction of the LIDAR frame.
double Extent(const BoardOptions& board, const Rigid3& lidar_from_target,
              const Vector3d& direction) {
  const Vector3d local = lidar_from_target.rotation.conjugate() * direction;
  return 0.5 * (board.width_m * std::abs(local.x()) + board.height_m * std::abs(local.y()));
}

}  // namespace

void AddPerson(double x, double y, double ground_z, double temperature,
               std::vector<SceneObject>* objects) {
  const Material skin = Skin(temperature + 1);
  const Material shirt = Cloth(0.55, 0.08, 0.07, 0.45, temperature);
  const Material trousers = Cloth(0.06, 0.09, 0.22, 0.35, temperature - 0.7);
  const Material hair = Cloth(0.05, 0.035, 0.02, 0.2, temperature - 1);
  const auto at = [&](double dx, double dy, double z) {
    return Vector3d(x + dx, y + dy, ground_z + z);
  };
  const auto add = [&](const char* name, const Mesh& mesh, const Material& material) {
    objects->push_back({name, mesh, material});
  };
  for (const double side : {-1.0, 1.0}) {
    add("leg", MakeRod(at(0, side * 0.11, 0.06), at(0, side * 0.09, 0.9), 0.065, 0.095), trousers);
    add("shoe", MakeEllipsoid(at(-0.06, side * 0.11, 0.05), {0.14, 0.055, 0.05}), hair);
    add("arm", MakeRod(at(0, side * 0.22, 1.42), at(-0.05, side * 0.34, 1.12), 0.055, 0.045),
        shirt);
    add("forearm",
        MakeRod(at(-0.05, side * 0.34, 1.12), at(-0.18, side * 0.30, 0.90), 0.042, 0.034), skin);
    add("hand", MakeEllipsoid(at(-0.2, side * 0.295, 0.86), {0.045, 0.035, 0.06}), skin);
  }
  add("torso", MakeEllipsoid(at(0, 0, 1.18), {0.14, 0.23, 0.36}), shirt);
  add("neck", MakeRod(at(0, 0, 1.45), at(0, 0, 1.6), 0.055, 0.055), skin);
  add("head", MakeEllipsoid(at(0, 0, 1.66), {0.095, 0.08, 0.12}), skin);
  add("hair", MakeEllipsoid(at(0.02, 0, 1.70), {0.095, 0.085, 0.10}), hair);
}

std::vector<SceneObject> MakeHands(const Options& options, const Rigid3& lidar_from_target) {
  const HolderOptions& holder = options.holder;
  std::vector<SceneObject> objects;
  const double x = 0.5 * options.board.width_m;
  const double y = 0.5 * options.board.height_m;
  const Vector3d places[4] = {{-x, 0.2 * y, 0}, {x, -0.3 * y, 0}, {0.25 * x, -y, 0}, {0, y, 0}};
  const Vector3d outwards[4] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}};
  for (int i = 0; i < holder.hands; ++i) {
    AddHand(holder, places[i], outwards[i], lidar_from_target, &objects);
  }
  if (holder.person) {
    const Vector3d& centre = lidar_from_target.translation;
    const Vector3d away = Vector3d(centre.x(), centre.y(), 0).normalized();
    // Hands and toes reach 0.25 m forwards: they do not touch a leaning board.
    const Vector3d feet = centre + (Extent(options.board, lidar_from_target, away) + 0.3) * away +
                          holder.person_aside_m * Vector3d::UnitZ().cross(away);
    AddPerson(feet.x(), feet.y(), options.world.ground_z_m, options.world.person_temperature_k,
              &objects);
  }
  return objects;
}

}  // namespace rgbdt::simulate
