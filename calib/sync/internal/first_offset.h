#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/model/rig.h"
#include "calib/sync/internal/image_motion.h"
#include "calib/sync/sync.h"

namespace rgbdt::sync {

/// The board in a camera's axes over time, from single images: straight and evenly from one to the
/// next.
class CameraTrack {
 public:
  CameraTrack(const std::vector<PosedImage>& images, double most_gap_s)
      : images_(&images), most_gap_(FromSeconds(most_gap_s)) {}

  /// camera_from_target at a time of the camera's clock; nothing across a longer gap.
  std::optional<Rigid3> At(Utime utime) const;

 private:
  const std::vector<PosedImage>* images_;
  Utime most_gap_;
};

/// The board's speed as a camera sees it, over 0.4 s each: noise of single images hardly counts.
struct BoardSpeed {
  double speed = 0, turn_speed = 0;  ///< RMS [m/s, rad/s]
};
BoardSpeed SpeedOf(const CameraTrack& track, const std::vector<PosedImage>& images);

/// Where a camera's search begins.
struct FirstOffset {
  std::string why_not;  ///< empty: found
  double offset_s = 0;
  Rigid3 camera_from_lidar;
};

/// The offset within +-most_offset_s by which the sweeps' points lie best on the board where the
/// images have it, to some milliseconds. Without a pose, the offset is the one by which the board
/// has moved as far between sweeps as between images (which needs no pose), and the pose then that
/// by which centres and normals fit best. `boards`: those of the sweeps; a half turn does not
/// count.
FirstOffset FindFirstOffset(const CameraTrack& track, const std::vector<WavedSweep>& sweeps,
                            const Target& target, const std::optional<Rigid3>& camera_from_lidar,
                            const SyncOptions& options);

}  // namespace rgbdt::sync
