#pragma once

#include <memory>
#include <optional>

#include "calib/model/cloud.h"
#include "calib/simulate/internal/scanner.h"
#include "calib/simulate/internal/spinning.h"
#include "calib/simulate/internal/world.h"
#include "calib/simulate/options.h"

namespace rgbdt::simulate {

/// The scene with the board in one place, for clouds alone: nothing is rendered, and cameras need
/// not see the board.
class CloudWorld {
 public:
  /// The board at pose `index` (0, 1, ...) of what options.pose allow, wholly in the field of
  /// options.livox, options.spinning or else options.scanner. Throws InputError where no pose is
  /// found.
  CloudWorld(const Options& options, int index);
  /// The board at a pose, whatever options.pose say; without one, the scene alone.
  CloudWorld(const Options& options, const std::optional<Rigid3>& lidar_from_target);

  /// Throws std::logic_error where there is no board.
  const Rigid3& lidar_from_target() const;
  const World& world() const { return world_; }
  Target target() const { return MakeTarget(options_.board); }

  /// By the turned scanner: organised, line x beam, with origins.
  Cloud TurnedSweep(Utime utime) const;
  /// By any spinning LIDAR: organised, ring x azimuth.
  Cloud SpinningSweep(const SpinningOptions& spinning, Utime utime) const;
  /// By the rig's LIDAR: options.livox, options.spinning or else the turned scanner.
  Cloud Sweep(Utime utime) const;

 private:
  CloudWorld(const Options& options, const std::shared_ptr<const SceneModel>& scene, int index);
  CloudWorld(const Options& options, std::shared_ptr<const SceneModel> scene,
             const std::optional<Rigid3>& lidar_from_target);

  Options options_;
  Scanner scanner_;
  World world_;
};

}  // namespace rgbdt::simulate
