#include "services/nodes/fuser_node.h"

#include <algorithm>

#include "calib/files/rig_file.h"
#include "calib/model/errors.h"

namespace rgbdt {

Messages FuserNode::Handle(const Message& message) {
  if (const auto* text = std::get_if<RigText>(&message)) {
    OnRig(*text);
    return {};
  }
  if (!rig_) throw InputError("no rig heard yet; start rgbdt-session, or publish RIG");
  if (const auto* chunk = std::get_if<CloudChunk>(&message)) return OnChunk(*chunk);
  if (const auto* image = std::get_if<Image>(&message)) {
    OnImage(*image);
  } else if (const auto* calibration = std::get_if<CalibrationMessage>(&message)) {
    OnCalibration(*calibration);
  }
  return {};
}

void FuserNode::OnRig(const RigText& text) {
  if (rig_ && rig_->hash == text.hash) return;
  rig_ = ParseRig(text.text, "RIG message");
  cameras_.clear();
  for (const CameraSpec& camera : rig_->cameras) cameras_.emplace_back(camera);
  newest_image_.clear();
  calibration_utime_ = 0;
}

void FuserNode::OnImage(const Image& image) {
  FusionCamera& camera = CameraOf(image.camera);
  if (image.shutter_correcting) {
    ++shutter_frames_;
    return;
  }
  PreparedImage prepared = Prepare(camera.spec(), image);
  Utime& newest = newest_image_[image.camera];
  if (image.utime < newest - kClockReset) {
    FusionCamera anew(camera.spec());
    anew.calibrated = camera.calibrated;
    anew.camera_from_lidar = camera.camera_from_lidar;
    camera = std::move(anew);
    newest = 0;
  }
  newest = std::max(newest, image.utime);
  camera.AddImage(std::move(prepared));
}

FusionCamera& FuserNode::CameraOf(const std::string& name) {
  rig_->Camera(name);  // throws with the names that there are
  return *std::find_if(cameras_.begin(), cameras_.end(),
                       [&](const FusionCamera& c) { return c.spec().name == name; });
}

void FuserNode::OnCalibration(const CalibrationMessage& message) {
  if (message.rig_hash != rig_->hash) {
    throw InputError("calibration was made with rig " + message.rig_hash + ", this is rig " +
                     rig_->hash);
  }
  FusionCamera& camera = CameraOf(message.calibration.camera);
  camera.camera_from_lidar = message.calibration.camera_from_lidar;
  camera.calibrated = true;
  calibration_utime_ = message.utime;
}

Messages FuserNode::OnChunk(const CloudChunk& chunk) {
  RgbdtCloud fused = Fuse(chunk.cloud, cameras_);
  fused.sweep_end = chunk.sweep_end;
  fused.calibration_utime.assign(fused.cameras.size(), calibration_utime_);
  points_ += static_cast<std::int64_t>(fused.size());
  coloured_ += std::count_if(fused.valid.begin(), fused.valid.end(),
                             [](std::uint32_t valid) { return valid != 0; });
  // What served only points well before this chunk serves no more.
  if (!fused.utime.empty()) {
    for (FusionCamera& camera : cameras_) {
      camera.ForgetBefore(fused.utime.front() - kMicrosecondsPerSecond);
    }
  }
  return {std::move(fused)};
}

Status FuserNode::GetStatus() const {
  Status status;
  status.ready = rig_.has_value();
  status.text = !rig_                     ? "waits for the rig (RIG)"
                : calibration_utime_ == 0 ? "no calibration yet: clouds go out without colour"
                                          : "fusing";
  status.counters = {
      {"points", points_}, {"coloured", coloured_}, {"shutter frames", shutter_frames_}};
  return status;
}

}  // namespace rgbdt
