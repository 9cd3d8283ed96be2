#include "calib/simulate/internal/cloud_world.h"

#include <stdexcept>
#include <string>
#include <utility>

#include "calib/model/errors.h"
#include "calib/simulate/internal/board_poses.h"
#include "calib/simulate/internal/livox.h"

namespace rgbdt::simulate {
namespace {

std::shared_ptr<const SceneModel> Scenery(const Options& options) {
  options.Check();
  return std::make_shared<SceneModel>(MakeScene(options));
}

Rigid3 DrawPose(const Options& options, const std::shared_ptr<const SceneModel>& scene, int index) {
  if (index < 0) {
    throw InputError("simulator: pose index is " + std::to_string(index) + "; expected 0 or more");
  }
  const World empty(scene, std::nullopt, options);
  return BoardPose(options, empty, Scanner(options.scanner, options.seed), {}, index);
}

std::optional<Board> MakeBoard(const Options& options,
                               const std::optional<Rigid3>& lidar_from_target) {
  if (!lidar_from_target) return std::nullopt;
  return Board(options.board, *lidar_from_target, HeatMap());
}

}  // namespace

CloudWorld::CloudWorld(const Options& options, int index)
    : CloudWorld(options, Scenery(options), index) {}

CloudWorld::CloudWorld(const Options& options, const std::optional<Rigid3>& lidar_from_target)
    : CloudWorld(options, Scenery(options), lidar_from_target) {}

CloudWorld::CloudWorld(const Options& options, const std::shared_ptr<const SceneModel>& scene,
                       int index)
    : CloudWorld(options, scene, std::optional<Rigid3>(DrawPose(options, scene, index))) {}

CloudWorld::CloudWorld(const Options& options, std::shared_ptr<const SceneModel> scene,
                       const std::optional<Rigid3>& lidar_from_target)
    : options_(options),
      scanner_(options.scanner, options.seed),
      world_(std::move(scene), MakeBoard(options, lidar_from_target), options) {}

const Rigid3& CloudWorld::lidar_from_target() const {
  if (!world_.board()) throw std::logic_error("the simulated scene has no board");
  return world_.board()->lidar_from_target();
}

Cloud CloudWorld::TurnedSweep(Utime utime) const {
  return scanner_.Sweep(world_, utime, options_.threads);
}

Cloud CloudWorld::SpinningSweep(const SpinningOptions& spinning, Utime utime) const {
  return simulate::SpinningSweep(world_, spinning, options_.seed, utime, options_.threads);
}

Cloud CloudWorld::Sweep(Utime utime) const {
  if (options_.livox) {
    return LivoxCloud(world_, *options_.livox, options_.seed, utime, options_.threads);
  }
  return options_.spinning ? SpinningSweep(*options_.spinning, utime) : TurnedSweep(utime);
}

}  // namespace rgbdt::simulate
