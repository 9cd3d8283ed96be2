#include "services/nodes/monitor_node.h"

#include <cmath>
#include <utility>

#include "calib/camera/pixels.h"
#include "calib/files/schema/rig_file.h"
#include "calib/model/errors.h"
#include "services/nodes/rig_check.h"

namespace rgbdt {

MonitorNode::MonitorNode(const MonitorOptions& options, std::optional<GivenCalibration> given)
    : options_(options), given_(std::move(given)) {
  options_.watch.Check();
  if (options_.every < 0) {
    throw InputError("every is " + std::to_string(ToSeconds(options_.every)) +
                     " s; expected 0 or more");
  }
  if (given_) {
    RequireSound(given_->calibration, given_->rig, given_->names, Use::kIfSound);
  }
}

Messages MonitorNode::Handle(const Message& message) {
  if (const auto* text = std::get_if<RigText>(&message)) {
    OnRig(*text);
    return {};
  }
  if (!rig_) throw InputError("no rig heard yet; start rgbdt-session, or publish RIG");
  if (const auto* chunk = std::get_if<CloudChunk>(&message)) return OnChunk(*chunk);
  if (const auto* image = std::get_if<Image>(&message)) {
    CheckImage(rig_->Camera(image->camera), *image);
    const auto watch = watches_.find(image->camera);
    shots_.Add(*image,
               watch != watches_.end() ? watch->second.calibration()->timing : std::nullopt);
  } else if (const auto* calibration = std::get_if<CalibrationMessage>(&message)) {
    OnCalibration(*calibration);
  } else if (const auto* pose = std::get_if<StampedPose>(&message)) {
    OnPose(*pose);
  }
  return {};
}

void MonitorNode::OnRig(const RigText& text) {
  if (rig_ && rig_->hash == text.hash) return;
  Rig rig = ParseRig(text.text, "RIG message");
  rig_before_ = std::exchange(rig_, std::move(rig));
  shots_ = ShotCollector();
  watches_.clear();
  unwatched_.clear();
  newest_.clear();
  looked_ = 0;
}

void MonitorNode::OnCalibration(const CalibrationMessage& message) {
  const CameraCalibration& calibration = message.calibration;
  const CameraSpec& spec = rig_->Camera(calibration.camera);
  RequireRigOf(message, *rig_, rig_before_ ? &*rig_before_ : nullptr, Use::kIfSound);
  if (const std::string why = WhyNotToUse(calibration); !why.empty()) {
    if (std::exchange(unwatched_[calibration.camera], why) != why) Warn(why);
    return;
  }
  unwatched_.erase(calibration.camera);
  watches_.try_emplace(calibration.camera, spec, options_.watch)
      .first->second.SetCalibration(calibration, message.utime);
}

void MonitorNode::OnPose(const StampedPose& pose) {
  if (shots_.Add(pose) == PoseTrack::Added::kJump) ++pose_jumps_;
}

Messages MonitorNode::OnChunk(const CloudChunk& chunk) {
  const Utime name = chunk.cloud.sweep_utime;
  if (!shots_.Add(chunk)) return {};
  ++sweeps_;
  // A sweep of before: the clock was set back, and time begins anew.
  if (looked_ != 0 && name >= looked_ && name < looked_ + options_.every) return {};
  const std::optional<Cloud> sweep = shots_.Complete(name);
  if (!sweep) return {};
  looked_ = name;
  return Look(*sweep);
}

Messages MonitorNode::Look(const Cloud& sweep) {
  ++looks_;
  Messages said;
  for (auto& [camera, watch] : watches_) {
    std::optional<TakenShot> shot =
        shots_.ShotOf(sweep, watch.spec(), watch.calibration()->camera_from_lidar);
    if (!shot) {
      ++without_image_;
      continue;
    }
    shot->image.utime = shot->taken;
    const MountCheck check = watch.Add({std::to_string(sweep.sweep_utime),
                                        &shot->cloud,
                                        &shot->image,
                                        {0, shot->map_from_lidar.value_or(Rigid3())}});
    const auto before = newest_.find(camera);
    const bool is_alarm = check.state == MountState::kMoved || check.state == MountState::kLost;
    if (is_alarm && (before == newest_.end() || before->second.state != check.state)) {
      ++alarms_;
      Warn(camera + " " + check.text);
    }
    newest_[camera] = check;
    said.emplace_back(check);
  }
  return said;
}

Messages MonitorNode::Advance(Utime now) {
  if (!given_ || !repeat_.IsDue(now)) return {};
  RigText rig;
  rig.text = given_->rig.text;
  rig.hash = given_->rig.hash;
  OnRig(rig);
  Messages said{rig};
  for (const CameraCalibration& camera : given_->calibration.cameras) {
    const CalibrationMessage message{0, given_->calibration.utime, given_->rig.hash,
                                     given_->calibration.method, camera};
    OnCalibration(message);
    said.emplace_back(message);
  }
  return said;
}

Status MonitorNode::GetStatus() const {
  Status status;
  status.ready = rig_.has_value();
  if (!rig_) {
    status.text = "waits for the rig (RIG)";
  } else if (watches_.empty() && unwatched_.empty()) {
    status.text = "waits for a calibration (CALIBRATION)";
  } else if (newest_.empty() && unwatched_.empty()) {
    status.text = "waits for a sweep (CLOUD) and an image of its time";
  }
  const auto add = [&](const std::string& camera, const char* between, const std::string& what) {
    if (!status.text.empty()) status.text += "; ";
    status.text += camera;
    status.text += between;
    status.text += what;
  };
  for (const auto& [camera, check] : newest_) add(camera, " ", check.text);
  for (const auto& [camera, why] : unwatched_) add(camera, " is not watched: ", why);
  status.counters = {{"sweeps", sweeps_},
                     {"looked at", looks_},
                     {"without an image or a pose of their time", without_image_},
                     {"alarms", alarms_},
                     {"pose jumps", pose_jumps_}};
  return status;
}

}  // namespace rgbdt
