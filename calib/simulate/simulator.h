#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/cloud.h"
#include "calib/model/image.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"
#include "calib/simulate/options.h"

namespace rgbdt::simulate {

/// The paper's rig with known truth. All noise is a function of (seed, utime, sensor) only.
class Simulator {
 public:
  explicit Simulator(const Options& options);
  ~Simulator();

  /// What the user would know: lenses, the hand-measured (wrong) guesses, the target. `text` and
  /// `hash` are empty.
  const Rig& rig() const;
  /// camera_from_lidar of each camera, reference_from_lidar of each further LIDAR; of every view
  /// shown so far lidar_from_target (where there is a board) and world_from_lidar (of natural
  /// scenes).
  const Truth& truth() const;

  /// Puts the board at view `index` (0, 1, ...; the pose is a function of seed and index) and
  /// renders what the cameras see, once. Sweeps of odd views turn the other way. In natural scenes
  /// the rig drives there, too.
  void ShowView(int index, const std::string& view_name);

  /// A sweep: `sweep_lines()` lines, line i begins at sweep_utime + i * line_period().
  int sweep_lines() const;
  Utime line_period() const;
  LineScan Line(Utime sweep_utime, int line) const;
  /// A line that begins at `utime`, wherever the motor is: its angle [rad] so many seconds later.
  LineScan LineAt(Utime utime, const std::function<double(double seconds)>& motor_angle) const;
  /// A revolution of the spinning LIDAR, or a Livox's cloud; throws InputError where the rig has
  /// neither.
  Cloud Revolution(Utime utime) const;
  /// A revolution of each LIDAR beside the rig's own, in its own frame.
  std::vector<LidarCloud> FurtherRevolutions(Utime utime) const;
  /// The encoder at a time; sweep_utime 0: standing still between sweeps.
  EncoderReading Encoder(Utime utime, Utime sweep_utime) const;
  Image TakeImage(const std::string& camera, Utime utime) const;
  /// What a person would click: the true outline corners + 1.5 px of noise. Throws InputError where
  /// there is no board.
  CornerSelection PickCorners(const std::string& camera, Utime image_utime) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rgbdt::simulate
