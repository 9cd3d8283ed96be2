#pragma once

#include <map>
#include <optional>
#include <string>

#include "calib/model/calibration.h"
#include "calib/model/mount_check.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// Carries calibrations along with what the monitor says of their mounts (MOUNT_CHECK): while a
/// camera has moved, its pose is the one that the scene tells, within the limits that the rig file
/// gives (FollowLimits); once it holds again, the calibration's. Where the scene cannot tell, what
/// was used stays.
class MountFollower {
 public:
  /// A camera's calibration as it came. False: it is the one at hand, repeated, and the pose that
  /// is used in its place stays.
  bool Take(const CameraCalibration& calibration, Utime utime);

  struct Step {
    CameraCalibration calibration;  ///< to use from now on
    Utime utime = 0;                ///< since when
  };
  /// What follows from a check; nothing: all stays. `said`: what changes, or why nothing does, in
  /// words; empty: there is nothing to say.
  std::optional<Step> Follow(const CameraSpec& spec, const MountCheck& check, std::string* said);

  /// Of the cameras that are carried along, in words; empty: none is.
  std::string Text() const;
  void Clear() { cameras_.clear(); }

 private:
  struct Camera {
    CameraCalibration calibration;
    Utime utime = 0;
    Rigid3 used;
    std::string text;  // while another pose than the calibration's is used
  };
  std::map<std::string, Camera> cameras_;
};

}  // namespace rgbdt
