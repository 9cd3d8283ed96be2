#include "calib/simulate/internal/holder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace rgbdt::simulate {
namespace {

using Eigen::Vector3d;

constexpr double kBehind = 0.15;     ///< from the board's back to the body [m]
constexpr double kLedge = 0.1;       ///< width of the easel's ledge [m]
constexpr double kLegWidth = 0.05;   ///< of the easel [m]
constexpr double kLongestLeg = 2.5;  ///< of an easel that lies on its side [m]

Material Plain(double reflectivity, double temperature_k) {
  Material material;
  material.albedo.setConstant(reflectivity);
  material.reflectivity = reflectivity;
  material.temperature_k = temperature_k;
  return material;
}

/// Horizontal unit vector from the board's front to its back.
Vector3d BackwardsOverGround(const Rigid3& lidar_from_target) {
  Vector3d away = lidar_from_target.rotation * Vector3d::UnitZ();
  away.z() = 0;
  // A board that lies flat has no such side: away from the LIDAR then.
  if (away.norm() < 1e-3)
    away = {lidar_from_target.translation.x(), lidar_from_target.translation.y(), 0};
  return away.norm() > 0 ? away.normalized() : Vector3d::UnitX();
}

/// The two sides' middles that lie most nearly at the same height: where a person grips the board.
/// Target frame.
std::array<Vector3d, 2> Grips(const Board& board) {
  const Eigen::Quaterniond& r = board.lidar_from_target().rotation;
  const bool across =
      std::abs((r * Vector3d::UnitX()).z()) <= std::abs((r * Vector3d::UnitY()).z());
  const Vector3d grip = across ? Vector3d(0.5 * board.options().width_m, 0, 0)
                               : Vector3d(0, 0.5 * board.options().height_m, 0);
  return {-grip, grip};
}

/// Torso, head and legs over the point where x = y = 0 on the ground, with the shoulders' height.
struct Body {
  std::vector<Mesh> clothed, bare;
  double shoulders = 0;
};

Body MakeBody(double torso) {
  Body body;
  body.shoulders = torso + 0.25;
  body.clothed.push_back(MakeEllipsoid({0, 0, torso}, {0.13, 0.22, 0.36}));
  for (const double side : {-1.0, 1.0}) {
    body.clothed.push_back(
        MakeRod({0, side * 0.11, 0}, {0, side * 0.09, torso - 0.2}, 0.065, 0.095));
  }
  body.bare.push_back(MakeRod({0, 0, torso + 0.25}, {0, 0, torso + 0.42}, 0.055, 0.055));
  body.bare.push_back(MakeEllipsoid({0, 0, torso + 0.5}, {0.095, 0.08, 0.12}));
  return body;
}

/// How far the body must be moved along `backwards` so that all of it that is as high as the board
/// stands `kBehind` behind its back.
double StepBack(const Board& board, const Body& body, const Rigid3& lidar_from_body,
                const Vector3d& backwards) {
  const Rigid3& pose = board.lidar_from_target();
  const Vector3d away = pose.rotation * Vector3d::UnitZ();
  double low = std::numeric_limits<double>::infinity(), high = -low, nearest = low;
  for (const Vector3d& corner : MakeTarget(board.options()).OutlineCorners()) {
    low = std::min(low, (pose * corner).z() - 0.1);
    high = std::max(high, (pose * corner).z() + 0.1);
  }
  for (const std::vector<Mesh>* meshes : {&body.clothed, &body.bare}) {
    for (const Mesh& mesh : *meshes) {
      for (const Vector3d& vertex : mesh.vertices) {
        const Vector3d v = lidar_from_body * vertex;
        if (v.z() < low || v.z() > high) continue;
        nearest = std::min(nearest, away.dot(v - pose.translation));
      }
    }
  }
  if (!std::isfinite(nearest)) nearest = 0;  // the board is higher than the person
  const double needed = kBehind + board.options().thickness_m - nearest;
  return needed / std::max(0.1, away.dot(backwards));
}

/// A hand that covers a little of the border, and the arm to it from behind.
void AddArm(const Board& board, const Vector3d& grip, const Vector3d& shoulder,
            const Material& sleeve, const Material& skin, std::vector<SceneObject>* parts) {
  const Rigid3& pose = board.lidar_from_target();
  const double back = board.options().thickness_m;
  const Vector3d out = grip.normalized();
  const Vector3d centre = grip + 0.01 * out + Vector3d(0, 0, 0.5 * back);
  const Mesh hand = MakeEllipsoid(centre, {0.045, 0.045, 0.04});
  parts->push_back({"hand", Transformed(pose, hand), skin});
  const Vector3d wrist = pose * Vector3d(centre + Vector3d(0, 0, 0.05));
  parts->push_back({"arm", MakeRod(shoulder, wrist, 0.05, 0.035), sleeve});
}

std::vector<SceneObject> Person(const Board& board, const Options& options) {
  const Rigid3& pose = board.lidar_from_target();
  const double warm = options.world.person_temperature_k;
  const Material shirt = Plain(0.45, warm);
  const Material skin = Plain(0.5, warm + 1);
  const Vector3d backwards = BackwardsOverGround(pose);
  const double ground = options.world.ground_z_m;
  const Body body = MakeBody(std::clamp(pose.translation.z() - ground, 1.0, 1.35));
  Rigid3 lidar_from_body =
      RotationAbout(Vector3d::UnitZ(), std::atan2(backwards.y(), backwards.x()));
  lidar_from_body.translation = {pose.translation.x(), pose.translation.y(), ground};
  lidar_from_body.translation += StepBack(board, body, lidar_from_body, backwards) * backwards;
  std::vector<SceneObject> parts;
  for (const Mesh& mesh : body.clothed) {
    parts.push_back({"body", Transformed(lidar_from_body, mesh), shirt});
  }
  for (const Mesh& mesh : body.bare) {
    parts.push_back({"head", Transformed(lidar_from_body, mesh), skin});
  }
  const Vector3d left = lidar_from_body.rotation * Vector3d::UnitY();
  for (const Vector3d& grip : Grips(board)) {
    const double side = left.dot(pose.rotation * grip) < 0 ? -0.2 : 0.2;
    AddArm(board, grip, lidar_from_body * Vector3d(0, side, body.shoulders), shirt, skin, &parts);
  }
  return parts;
}

/// A box in the board's plane, flush with its front: from `from` to `to` along `down`, with this
/// half width along `side`; all in the target frame.
Mesh Bar(const Board& board, const Vector3d& down, const Vector3d& side, double from, double to,
         double middle, double half) {
  const Vector3d a = from * down + (middle - half) * side;
  const Vector3d b =
      to * down + (middle + half) * side + Vector3d(0, 0, board.options().thickness_m);
  return Transformed(board.lidar_from_target(), MakeBox(a.cwiseMin(b), a.cwiseMax(b)));
}

/// The ledge under the lowest side, and two legs from there to the ground.
std::vector<Mesh> EaselFront(const Board& board, double ground) {
  const Rigid3& pose = board.lidar_from_target();
  Vector3d down = Vector3d::UnitY();
  for (const Vector3d& d : {Vector3d(1, 0, 0), Vector3d(-1, 0, 0), Vector3d(0, -1, 0)}) {
    if ((pose.rotation * d).z() < (pose.rotation * down).z()) down = d;
  }
  const bool upright = down.x() == 0;
  const Vector3d side = upright ? Vector3d::UnitX() : Vector3d::UnitY();
  const double width = upright ? board.options().width_m : board.options().height_m;
  const double edge = 0.5 * (upright ? board.options().height_m : board.options().width_m);
  const double drop = -(pose.rotation * down).z();
  std::vector<Mesh> parts{Bar(board, down, side, edge, edge + kLedge, 0, 0.5 * width)};
  for (const double middle : {-0.3 * width, 0.3 * width}) {
    const double start = edge + kLedge;
    const double height = (pose * Vector3d(start * down + middle * side)).z() - ground;
    const double length = std::clamp(height / std::max(0.01, drop), 0.05, kLongestLeg);
    parts.push_back(Bar(board, down, side, start, start + length, middle, 0.5 * kLegWidth));
  }
  return parts;
}

}  // namespace

std::vector<SceneObject> MakeHolder(const Board& board, const Options& options, double air_k) {
  if (options.clutter.holder == Holder::kPerson) return Person(board, options);
  std::vector<SceneObject> parts;
  const Material material = Plain(options.board.stand_reflectivity, air_k);
  const double ground = options.world.ground_z_m;
  for (const Mesh& part : board.Stand(ground)) parts.push_back({"stand", part, material});
  if (options.clutter.holder == Holder::kEasel) {
    for (const Mesh& part : EaselFront(board, ground)) parts.push_back({"easel", part, material});
  }
  return parts;
}

}  // namespace rgbdt::simulate
