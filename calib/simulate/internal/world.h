#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "calib/simulate/internal/board.h"
#include "calib/simulate/internal/ray_caster.h"
#include "calib/simulate/internal/scene.h"

namespace rgbdt::simulate {

/// The material that a ray meets.
struct Surface {
  Material material;
  int patch = -1;  ///< of the board's front (Board::Patch); -1 elsewhere
};

/// The scene, with or without the board: what rays are shot into. May be used by several threads.
class World {
 public:
  World(std::shared_ptr<const SceneModel> scene, std::optional<Board> board,
        const Options& options);

  const SceneModel& scene() const { return *scene_; }
  const RayCaster& caster() const { return caster_; }
  const std::optional<Board>& board() const { return board_; }
  void set_heat(const HeatMap& heat) { board_->set_heat(heat); }

  bool IsBoard(const Hit& hit) const { return board_ && hit.object == board_object_; }
  /// Board, stand or who holds it: what the next view will have elsewhere.
  bool IsMoving(const Hit& hit) const { return hit.object >= board_object_; }
  /// Whether a ray comes near any of these (their boxes along the axes; no false "no").
  bool MayMeetMoving(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;
  /// What the ray met, of the scene or of what holds the board. Not for the board itself.
  const SceneObject& Object(const Hit& hit) const;
  /// A direction of the LIDAR frame in the world's, where sky and textures lie.
  Eigen::Vector3d InWorld(const Eigen::Vector3d& direction) const;
  /// Number of an object's face: neighbouring pixels that differ in it have an edge between them.
  int Face(const Hit& hit) const;

  /// `hit` must be one; `footprint_m` is the distance of two rays there.
  Surface At(const Hit& hit, const Eigen::Vector3d& point, double footprint_m) const;
  /// Reflectivity at the LIDAR's wavelength.
  double Reflectivity(const Hit& hit, const Eigen::Vector3d& point) const;

 private:
  struct Box {
    Eigen::Vector3d low, high;
  };

  std::shared_ptr<const SceneModel> scene_;
  std::optional<Board> board_;
  int board_object_;
  std::vector<SceneObject> holder_;  ///< what holds the board: numbered after it
  std::vector<Mesh> meshes_;
  RayCaster caster_;
  std::vector<Box> moving_;
};

}  // namespace rgbdt::simulate
