#include "calib/simulate/internal/world.h"

#include <algorithm>
#include <utility>

#include "calib/simulate/internal/holder.h"
#include "calib/simulate/internal/people.h"

namespace rgbdt::simulate {
namespace {

std::vector<SceneObject> HolderOf(const std::optional<Board>& board, const Options& options,
                                  const SceneModel& scene) {
  if (!board) return {};
  std::vector<SceneObject> parts = MakeHolder(*board, options, scene.air_k);
  for (SceneObject& hand : MakeHands(options, board->lidar_from_target())) {
    parts.push_back(std::move(hand));
  }
  return parts;
}

std::vector<Mesh> CollectMeshes(const SceneModel& scene, const std::optional<Board>& board,
                                const std::vector<SceneObject>& holder) {
  std::vector<Mesh> meshes;
  for (const SceneObject& object : scene.objects) meshes.push_back(object.mesh);
  if (board) meshes.push_back(board->Shape());
  for (const SceneObject& part : holder) meshes.push_back(part.mesh);
  return meshes;
}

}  // namespace

World::World(std::shared_ptr<const SceneModel> scene, std::optional<Board> board,
             const Options& options)
    : scene_(std::move(scene)),
      board_(std::move(board)),
      board_object_(static_cast<int>(scene_->objects.size())),
      holder_(HolderOf(board_, options, *scene_)),
      meshes_(CollectMeshes(*scene_, board_, holder_)),
      caster_(meshes_) {
  for (std::size_t i = scene_->objects.size(); i < meshes_.size(); ++i) {
    Box box{meshes_[i].vertices[0], meshes_[i].vertices[0]};
    for (const Eigen::Vector3d& vertex : meshes_[i].vertices) {
      box.low = box.low.cwiseMin(vertex);
      box.high = box.high.cwiseMax(vertex);
    }
    moving_.push_back({box.low.array() - 0.02, box.high.array() + 0.02});
  }
}

bool World::MayMeetMoving(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
  for (const Box& box : moving_) {
    double enter = 0;
    double leave = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
      const double inverse = 1 / (direction[k] == 0 ? 1e-30 : direction[k]);
      const double a = (box.low[k] - origin[k]) * inverse;
      const double b = (box.high[k] - origin[k]) * inverse;
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    if (enter <= leave) return true;
  }
  return false;
}

int World::Face(const Hit& hit) const {
  if (!hit.hit()) return 0;
  const bool round = meshes_[static_cast<std::size_t>(hit.object)].round();
  if (!IsBoard(hit) && Object(hit).material.leafy) {
    // Thousands of faces: eight numbers an object do not hold them.
    return 1 + hit.object * 8 + ((hit.triangle / 2 % (1 << 14)) << 16);
  }
  return 1 + hit.object * 8 + (round ? 0 : hit.triangle / 2);
}

Eigen::Vector3d World::InWorld(const Eigen::Vector3d& direction) const {
  const std::optional<Rigid3>& place = scene_->world_from_lidar;
  return place ? Eigen::Vector3d(place->rotation * direction) : direction;
}

const SceneObject& World::Object(const Hit& hit) const {
  const auto i = static_cast<std::size_t>(hit.object);
  return IsMoving(hit) ? holder_[i - scene_->objects.size() - 1] : scene_->objects[i];
}

Surface World::At(const Hit& hit, const Eigen::Vector3d& point, double footprint_m) const {
  Surface surface;
  if (IsBoard(hit)) {
    surface.material = board_->At(point, &surface.patch);
  } else if (Object(hit).pattern) {
    surface.material = Object(hit).pattern->At(point, &surface.patch);
  } else {
    const std::optional<Rigid3>& place = scene_->world_from_lidar;
    surface.material = Textured(Object(hit).material, place ? *place * point : point,
                                InWorld(hit.normal), footprint_m);
  }
  return surface;
}

double World::Reflectivity(const Hit& hit, const Eigen::Vector3d& point) const {
  if (IsBoard(hit)) return board_->Reflectivity(point);
  const SceneObject& object = Object(hit);
  // The LIDAR sees surfaces without their painted pattern, but for a board's.
  return object.pattern ? object.pattern->Reflectivity(point) : object.material.reflectivity;
}

}  // namespace rgbdt::simulate
