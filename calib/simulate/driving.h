#pragma once

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

/// A rig that drives through a natural scene: along a street without end (outdoor), round the free
/// middle of a room (indoor). Each beam of its spinning LIDAR starts from where the rig is at the
/// beam's time, each row of a rolling shutter from where it is at the row's; exposures are taken
/// for short. Nobody walks there. Noise is a function of (seed,
/// utime, sensor) only.
class Driving {
 public:
  static constexpr Utime kStart = 1'700'000'000 * kMicrosecondsPerSecond;

  /// `clocks`: one a camera; none: exact ones, and shutters that do not roll. Throws InputError for
  /// options that make no sense, a rig without a spinning LIDAR, a night.
  Driving(const Options& options, double speed_mps, std::vector<ClockOptions> clocks = {});
  ~Driving();

  /// What the user would know.
  const Rig& rig() const;
  /// camera_from_lidar of each camera.
  const Truth& truth() const;
  /// World: z up, its origin where the way has its own.
  Rigid3 WorldFromLidar(Utime utime) const;
  /// A revolution, from `utime` on.
  Cloud Sweep(Utime utime);
  /// `utime`: of the middle row, by the LIDAR's clock; the image's is its camera's.
  Image TakeImage(const std::string& camera, Utime utime);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rgbdt::simulate
