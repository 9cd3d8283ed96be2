#pragma once

#include <map>
#include <optional>
#include <string>

#include "calib/files/schema/calibration_use.h"
#include "calib/model/calibration.h"
#include "calib/model/rig.h"
#include "calib/monitor/mount_watch.h"
#include "services/nodes/shot_collector.h"
#include "services/runtime/node.h"
#include "services/runtime/periodic.h"

namespace rgbdt {

struct MonitorOptions {
  Utime every = 2 * kMicrosecondsPerSecond;  ///< of the sweeps, one in this time is looked at
  WatchOptions watch;
};

/// A calibration that was made before, with its rig.
struct GivenCalibration {
  Rig rig;
  Calibration calibration;
  UseNames names{"the calibration", "the rig"};
};

/// CLOUD + `<CAMERA>_IMAGE` + CALIBRATION + POSE -> MOUNT_CHECK, one for each calibrated camera and
/// sweep that is looked at: whether the calibration still holds (calib/monitor). Which image
/// belongs to a sweep, what is dropped and what is guaranteed: shot_collector.h. A calibration that
/// is not to be used, or is another rig's, is not watched. With a calibration given, it also sends
/// that: RIG and CALIBRATION, once a second, for who drives with a rig that was calibrated before.
class MonitorNode : public Node {
 public:
  /// Throws InputError for options that make no sense, and for a calibration that is not to be used
  /// or was made with another rig than it comes with.
  explicit MonitorNode(const MonitorOptions& options = {},
                       std::optional<GivenCalibration> given = std::nullopt);

  std::string name() const override { return "monitor"; }
  std::vector<std::string> Subscriptions() const override {
    return {"RIG", "CLOUD", ".*_IMAGE", "CALIBRATION", "POSE"};
  }
  Messages Handle(const Message& message) override;
  Messages Advance(Utime now) override;
  Status GetStatus() const override;

 private:
  void OnRig(const RigText& text);
  void OnCalibration(const CalibrationMessage& message);
  void OnPose(const StampedPose& pose);
  Messages OnChunk(const CloudChunk& chunk);
  Messages Look(const Cloud& sweep);

  MonitorOptions options_;
  std::optional<GivenCalibration> given_;
  Periodic repeat_{kMicrosecondsPerSecond};
  std::optional<Rig> rig_, rig_before_;
  ShotCollector shots_;
  std::map<std::string, MountWatch> watches_;     // by camera
  std::map<std::string, std::string> unwatched_;  // why a calibration is not watched, by camera
  std::map<std::string, MountCheck> newest_;      // by camera
  Utime looked_ = 0;                              // the sweep looked at last
  std::int64_t sweeps_ = 0, looks_ = 0, without_image_ = 0, alarms_ = 0, pose_jumps_ = 0;
};

}  // namespace rgbdt
