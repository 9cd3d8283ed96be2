#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/rigid3.h"
#include "calib/model/shot.h"
#include "calib/model/time.h"

namespace rgbdt {

/// What the scene says of a camera's mount. The numbers are those of the `mount_check_t` message.
enum class MountState {
  kCannotTell = 1,  ///< too few sweeps so far, or a scene that shows too little
  kHolds = 2,       ///< the camera sits where its calibration says, as far as can be told
  kMoved = 3,       ///< it does not: where it sits now is told
  kLost = 4,        ///< it does not fit any more, and where it sits now was not found
};

/// Whether a camera still sits where its calibration says, by the last few sweeps.
struct MountCheck {
  std::string camera;
  std::int64_t seq = 0;
  Utime utime = 0;              ///< of the newest image
  Utime calibration_utime = 0;  ///< which calibration is watched: CALIBRATION's own
  int sweeps = 0;               ///< that it is told by
  MountState state = MountState::kCannotTell;
  /// Probability that the calibration still holds; absent: the scene cannot tell.
  std::optional<double> holds{};
  /// Where the camera sits by scene and calibration together; as calibrated where nothing is told.
  Rigid3 camera_from_lidar;
  /// By which it moved: camera_from_lidar = Exp(moved) * that of the calibration.
  Vector6d moved = Vector6d::Zero();
  Matrix6d covariance = Matrix6d::Zero();  ///< of delta (rigid3.h) about camera_from_lidar
  /// Of delta's six numbers, how much the scene tells of each: 1 all, 0 nothing (1 - the variance
  /// left over that of what a mount may move by).
  std::array<double, 6> told{};
  double edges = 0;  ///< depth edges of the sweeps that lie in the image
  double shown = 0;  ///< of these, the share that the image shows, in expectation
  std::array<double, kImageParts> where{};  ///< of the edges shown, the share in each, row by row
  std::string text;                         ///< for a person: what was found, and what to do
};

}  // namespace rgbdt
