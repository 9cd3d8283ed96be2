#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "calib/fuse/fuse.h"
#include "calib/model/rig.h"
#include "services/nodes/node.h"

namespace rgbdt {

/// CLOUD + <CAMERA>_IMAGE + CALIBRATION -> RGBDT_CLOUD, one message for each chunk, at once:
/// nothing waits for the future. A point is coloured by the image that serves its time (fuse.h), so
/// live and replay agree as long as `readout_s` in the rig file is not below the true delay. Before
/// a calibration comes the cloud goes out without colour. A calibration of another rig is refused.
/// An image older than the camera's newest by more than kClockReset means that the clock was set
/// back: the camera's images go.
class FuserNode : public Node {
 public:
  static constexpr Utime kClockReset = 10 * kMicrosecondsPerSecond;

  std::string name() const override { return "fuser"; }
  std::vector<std::string> Subscriptions() const override {
    return {"RIG", "CLOUD", ".*_IMAGE", "CALIBRATION"};
  }
  Messages Handle(const Message& message) override;
  Status GetStatus() const override;

 private:
  void OnRig(const RigText& text);
  void OnCalibration(const CalibrationMessage& message);
  void OnImage(const Image& image);
  FusionCamera& CameraOf(const std::string& name);
  Messages OnChunk(const CloudChunk& chunk);

  std::optional<Rig> rig_;
  std::vector<FusionCamera> cameras_;
  std::map<std::string, Utime> newest_image_;  // by camera
  Utime calibration_utime_ = 0;
  std::int64_t points_ = 0;
  std::int64_t coloured_ = 0;
  std::int64_t shutter_frames_ = 0;
};

}  // namespace rgbdt
