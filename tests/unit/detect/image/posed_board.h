#pragma once

#include <memory>
#include <optional>

#include "calib/camera/camera.h"
#include "calib/simulate/internal/board.h"
#include "calib/simulate/internal/camera_renderer.h"
#include "calib/simulate/internal/rig_defaults.h"
#include "calib/simulate/internal/scene.h"
#include "calib/simulate/internal/world.h"

namespace rgbdt {

/// One simulated camera at the LIDAR's place that looks straight ahead, and a board put where a
/// test wants it.
class PosedBoard {
 public:
  explicit PosedBoard(const simulate::CameraOptions& camera, const simulate::Options& options = {})
      : options_(options),
        scene_(std::make_shared<simulate::SceneModel>(simulate::MakeScene(options))),
        camera_from_lidar_(simulate::DrawCameraFromLidar(camera, options.seed)),
        renderer_(camera, camera_from_lidar_, options.supersampling, 0) {
    renderer_.RenderEmpty(simulate::World(scene_, std::nullopt, options_));
    spec_.name = camera.name;
    spec_.kind = camera.kind;
    spec_.width = camera.width;
    spec_.height = camera.height;
    spec_.lens = camera.lens;
    spec_.format =
        camera.kind == CameraKind::kColor ? PixelFormat::kBayerRg8 : PixelFormat::kMono16;
  }

  const CameraSpec& spec() const { return spec_; }
  Target target() const { return simulate::MakeTarget(options_.board); }

  /// Renders the board there.
  void Show(const Rigid3& camera_from_target) {
    const simulate::HeatMap heat =
        simulate::DrawHeat(options_.board, scene_->board_heat, options_.seed, 0);
    const Rigid3 lidar_from_target = camera_from_lidar_.Inverse() * camera_from_target;
    renderer_.Render(simulate::World(
        scene_, simulate::Board(options_.board, lidar_from_target, heat), options_));
  }

  /// What was rendered, with the noise of number `shot`.
  Image Take(int shot) const { return renderer_.Take(options_.seed, 1000 * (shot + 1)); }

 private:
  simulate::Options options_;
  std::shared_ptr<const simulate::SceneModel> scene_;
  Rigid3 camera_from_lidar_;
  simulate::CameraRenderer renderer_;
  CameraSpec spec_;
};

}  // namespace rgbdt
