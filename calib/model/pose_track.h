#pragma once

#include <deque>
#include <optional>

#include "calib/model/session.h"

namespace rgbdt {

/// Where the rig was over time, from a pose stream of any source. Between two poses: straight and
/// evenly along Exp. Up to kAhead after the newest: on as between the last two. A single pose holds
/// for all times: a rig that stands.
class PoseTrack {
 public:
  static constexpr Utime kGap = kMicrosecondsPerSecond;  ///< no way is known across a longer one
  static constexpr Utime kAhead = kMicrosecondsPerSecond / 5;
  static constexpr Utime kKept = 30 * kMicrosecondsPerSecond;
  static constexpr double kMostSpeed = 50;  ///< [m/s], and kMostTurn [rad/s]: faster is a jump
  static constexpr double kMostTurn = 10;

  enum class Added {
    kYes,
    kOld,   ///< not newer than the newest: not taken
    kJump,  ///< no rig moves like this, or the clock was set back: the track begins anew
  };
  Added Add(const StampedPose& pose);

  /// map_from_lidar at a time; nothing where the stream does not tell.
  std::optional<Rigid3> At(Utime utime) const;

  bool empty() const { return poses_.empty(); }

 private:
  std::deque<StampedPose> poses_;  // rising in time, none farther from the next than a jump
};

}  // namespace rgbdt
