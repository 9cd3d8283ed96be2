#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/cloud.h"
#include "calib/model/image.h"
#include "calib/model/rig.h"
#include "calib/simulate/clocks.h"
#include "calib/simulate/options.h"

namespace rgbdt::simulate {

/// How a person waves the board: to and fro along and about each axis, each with two frequencies
/// and phases that the seed draws. LIDAR axes, about a place straight ahead.
struct WaveOptions {
  double range_m = 3;                          ///< of the middle
  double height_m = -0.3;                      ///< of the middle, over the LIDAR
  Eigen::Vector3d reach_m{0.4, 0.4, 0.2};      ///< most along x, y, z
  Eigen::Vector3d turn_rad = {0.4, 0.4, 0.4};  ///< most about x, y, z
  /// Most that the rig turns about its own x, y, z meanwhile, in the same way. The board moves as
  /// this looks from the rig; what stands about does not.
  Eigen::Vector3d rig_turn_rad = {0, 0, 0};
  double slowest_hz = 0.25, fastest_hz = 0.7;  ///< of what is drawn
  Utime start = 1'700'000'000 * kMicrosecondsPerSecond;

  /// Throws InputError naming the field and its value.
  void Check() const;
};

/// The rig before a board that is waved: a spinning LIDAR each of whose beams has its own time, and
/// cameras whose rows have theirs. The board meets the beams as a thin sheet; nobody holds it
/// there. Exposures are taken for short: nothing is blurred by motion. Noise is a function of
/// (seed, utime, sensor) only.
class Waving {
 public:
  /// `clocks`: one a camera. Throws InputError for options that make no sense, and for a rig
  /// without a spinning LIDAR.
  Waving(const Options& options, const WaveOptions& wave, std::vector<ClockOptions> clocks);
  ~Waving();

  /// What the user would know: nothing of the clocks and shutters.
  const Rig& rig() const;
  /// camera_from_lidar of each camera.
  const Truth& truth() const;
  /// Where the board is at a time by the LIDAR's clock.
  Rigid3 LidarFromTarget(Utime utime) const;
  /// A revolution, as SpinningSweep has it.
  Cloud Sweep(Utime utime) const;
  /// Rendered. `utime`: of the middle row, by the LIDAR's clock; the image's is its camera's.
  Image TakeImage(const std::string& camera, Utime utime);
  /// Of that image the inner corners, without noise [px]; empty where one lies outside of it.
  std::vector<Eigen::Vector2d> Corners(const std::string& camera, Utime utime) const;
  /// The time that the camera's clock shows.
  Utime CameraUtime(const std::string& camera, Utime utime) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rgbdt::simulate
