#include "calib/simulate/world.h"

#include <algorithm>
#include <utility>

#include "calib/simulate/people.h"

namespace rgbdt::simulate {

World::World(std::shared_ptr<const SceneModel> scene, std::optional<Board> board,
             const Options& options)
    : scene_(std::move(scene)),
      board_(std::move(board)),
      holder_(board_ ? MakeHolder(options, board_->lidar_from_target())
                     : std::vector<SceneObject>()),
      board_object_(static_cast<int>(scene_->objects.size())),
      meshes_(CollectMeshes(options)),
      holder_object_(static_cast<int>(meshes_.size() - holder_.size())),
      caster_(meshes_) {
  for (std::size_t i = scene_->objects.size(); i < meshes_.size(); ++i) {
    Box box{meshes_[i].vertices[0], meshes_[i].vertices[0]};
    for (const Eigen::Vector3d& vertex : meshes_[i].vertices) {
      box.low = box.low.cwiseMin(vertex);
      box.high = box.high.cwiseMax(vertex);
    }
    moving_.push_back({box.low.array() - 0.02, box.high.array() + 0.02});
  }
  stand_.albedo.setConstant(options.board.stand_reflectivity);
  stand_.reflectivity = options.board.stand_reflectivity;
  stand_.temperature_k = scene_->air_k;
}

std::vector<Mesh> World::CollectMeshes(const Options& options) const {
  std::vector<Mesh> meshes;
  for (const SceneObject& object : scene_->objects) meshes.push_back(object.mesh);
  if (!board_) return meshes;
  meshes.push_back(board_->Shape());
  for (Mesh& part : board_->Stand(options.world.ground_z_m)) meshes.push_back(std::move(part));
  for (const SceneObject& object : holder_) meshes.push_back(object.mesh);
  return meshes;
}

const SceneObject* World::ObjectOf(const Hit& hit) const {
  if (!IsMoving(hit)) return &scene_->objects[static_cast<std::size_t>(hit.object)];
  if (hit.object < holder_object_) return nullptr;
  return &holder_[static_cast<std::size_t>(hit.object - holder_object_)];
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
  return 1 + hit.object * 8 + (round ? 0 : hit.triangle / 2);
}

Surface World::At(const Hit& hit, const Eigen::Vector3d& point, double footprint_m) const {
  Surface surface;
  if (IsBoard(hit)) {
    surface.material = board_->At(point, &surface.patch);
  } else if (const SceneObject* object = ObjectOf(hit)) {
    surface.material = Textured(object->material, point, hit.normal, footprint_m);
  } else {
    surface.material = stand_;
  }
  return surface;
}

double World::Reflectivity(const Hit& hit, const Eigen::Vector3d& point) const {
  if (IsBoard(hit)) return board_->Reflectivity(point);
  // The LIDAR sees surfaces without their painted pattern.
  const SceneObject* object = ObjectOf(hit);
  return object != nullptr ? object->material.reflectivity : stand_.reflectivity;
}

}  // namespace rgbdt::simulate
