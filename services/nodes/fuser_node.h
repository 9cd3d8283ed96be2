#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "calib/files/schema/calibration_use.h"
#include "calib/fuse/range_correction.h"
#include "calib/fuse/sweep_fuser.h"
#include "calib/model/rig.h"
#include "services/nodes/chunk_queue.h"
#include "services/nodes/mount_follower.h"
#include "services/runtime/node.h"

namespace rgbdt {

/// CLOUD + `<CAMERA>_IMAGE` + CALIBRATION + POSE -> RGBDT_CLOUD, one message for each chunk (more
/// for one of more than SweepFuser::kPartPoints), at once, and RGBDT_SWEEP, each sweep once more at
/// its end, tested for occlusion as a whole. Nothing waits for the future: a point is coloured by
/// the image that serves its time, so live and replay agree as long as `readout_s` in the rig file
/// is not below the true delay. Only clouds whose way rgbdt-odometry tells after them (a turned
/// scanner's) wait for it (ChunkQueue); of their images fewer are kept, evenly over time. Before a
/// calibration comes the cloud goes out without colour; a new one holds for what is not out yet. An
/// image older than the camera's newest by more than kClockReset means that the clock was set back:
/// the camera's images go. Memory is bounded. Where it has too little time the oldest images and
/// clouds that wait for it go (WantsNewest), so that what it says is of now; STATUS counts them as
/// gaps.
///
/// A calibration of another rig is refused (calibration_use.h); the rig heard before this one may
/// have been the same in all that counts. One that is not to be used is not taken, either: what
/// held before goes on, a warning tells the reason once, and so does the status for as long as that
/// is the camera's newest. With Use::kAnyway both are used, with the same warning.
///
/// With Ranges::kCorrected, chunks are corrected by the calibration's range errors as they come:
/// published points are where they truly are. Where cameras differ in these the first one's hold;
/// where there are none, chunks stay as measured. A warning tells either, once, at a sweep's end.
///
/// With Follow::kYes a camera whose mount moved is carried along by MOUNT_CHECK (MountFollower);
/// points then carry the check's time in place of the calibration's. Each change is a warning.
class FuserNode : public Node {
 public:
  static constexpr Utime kClockReset = 10 * kMicrosecondsPerSecond;
  enum class Ranges { kAsMeasured, kCorrected };
  enum class Follow { kNo, kYes };

  explicit FuserNode(Ranges ranges = Ranges::kAsMeasured, Use use = Use::kIfSound,
                     Follow follow = Follow::kNo)
      : ranges_(ranges), use_(use), follow_(follow) {}

  std::string name() const override { return "fuser"; }
  std::vector<std::string> Subscriptions() const override;
  bool WantsNewest() const override { return true; }
  Messages Handle(const Message& message) override;
  Messages Advance(Utime now) override;
  Status GetStatus() const override;

  /// Each camera that has a calibration has its newest, and one has.
  bool HasCalibrations() const { return calibrated() && against_.empty(); }

 private:
  void OnRig(const RigText& text);
  Messages OnCalibration(const CalibrationMessage& message);
  void Tell(const std::string& camera, const std::vector<std::string>& against);
  Messages OnMountCheck(const MountCheck& check);
  void OnImage(const Image& image);
  void OnPose(const StampedPose& pose);
  Messages OnChunk(const CloudChunk& chunk);
  Messages FuseDue();
  Messages FuseChunk(const CloudChunk& chunk);
  RgbdtCloud Fuse(const Cloud& cloud);
  void UpdateRangeCorrection();
  void WarnOfRanges();
  bool calibrated() const;
  std::size_t IndexOf(const std::string& camera) const;

  Ranges ranges_;
  Use use_;
  Follow follow_;
  MountFollower follower_;
  std::optional<Rig> rig_, rig_before_;
  // What speaks against a camera's newest calibration, by camera.
  std::map<std::string, std::string> against_;
  std::optional<SweepFuser> fuser_;  // while there is a rig
  ChunkQueue chunks_;
  RangeCorrection range_correction_;           // none where ranges stay as measured
  std::string ranges_warning_;                 // the last, until all is well again
  std::map<std::string, Utime> newest_image_;  // by camera
  std::int64_t shutter_frames_ = 0;
  std::int64_t pose_jumps_ = 0;
  std::int64_t old_poses_ = 0;
};

}  // namespace rgbdt
