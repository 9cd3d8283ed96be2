#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>

#include "calib/model/calibration.h"
#include "calib/model/image.h"
#include "calib/model/pose_track.h"
#include "calib/model/rig.h"
#include "calib/model/session.h"
#include "calib/scan_assembly/sweep_collector.h"

namespace rgbdt {

/// A sweep and one camera's image of the same moment, in which both hold: the cloud is as seen from
/// where the rig was when the image was taken.
struct TakenShot {
  Cloud cloud;
  Image image;
  Utime taken = 0;                         ///< the LIDAR's time of the image
  std::optional<Rigid3> map_from_lidar{};  ///< then; absent: no pose tells
};

/// Sweeps and images of a rig that drives, put together as they come, without a capture. To a sweep
/// belongs the image that was taken nearest to when the LIDAR looked where the camera looks, of
/// those that have come when the sweep ends: nothing waits for the future. While poses come the
/// cloud is taken to that image's moment (still_cloud.h); without poses the rig is taken to stand.
/// An image older than the camera's newest by more than kClockReset means that the clock was set
/// back: the camera's images go. A thermal camera's images from while its shutter corrects are left
/// out. Memory: kKept images a camera, spread over the time that they are from.
class ShotCollector {
 public:
  static constexpr std::size_t kKept = 32;
  static constexpr Utime kClockReset = 10 * kMicrosecondsPerSecond;
  static constexpr Utime kFarthest = 3 * kMicrosecondsPerSecond;  ///< before a sweep or after it

  /// `timing`: what the camera's calibration says of its clock.
  void Add(const Image& image, const std::optional<CameraTiming>& timing);
  PoseTrack::Added Add(const StampedPose& pose) { return poses_.Add(pose); }
  bool has_poses() const { return !poses_.empty(); }
  /// Throws InputError for a chunk that cannot be joined to those of its sweep. True: it ends its
  /// sweep.
  bool Add(CloudChunk chunk);
  std::optional<Cloud> Complete(Utime sweep_utime) const { return sweeps_.Complete(sweep_utime); }

  /// Nothing where no image is of the sweep's time, or the poses do not tell the rig's way.
  std::optional<TakenShot> ShotOf(const Cloud& sweep, const CameraSpec& camera,
                                  const Rigid3& camera_from_lidar) const;

 private:
  struct TimedImage {
    Image image;
    Utime taken = 0;
  };
  std::map<std::string, std::deque<TimedImage>> images_;  // by camera, rising in time
  SweepCollector sweeps_;
  PoseTrack poses_;
};

}  // namespace rgbdt
