#include "services/nodes/fuser_node.h"

#include <algorithm>
#include <utility>

#include "calib/files/schema/rig_file.h"
#include "calib/model/errors.h"
#include "services/nodes/rig_check.h"

namespace rgbdt {
namespace {

Messages MessagesOf(std::vector<RgbdtCloud> clouds) {
  Messages messages;
  for (RgbdtCloud& cloud : clouds) messages.emplace_back(std::move(cloud));
  return messages;
}

}  // namespace

std::vector<std::string> FuserNode::Subscriptions() const {
  std::vector<std::string> channels = {"RIG", "CLOUD", ".*_IMAGE", "CALIBRATION", "POSE"};
  if (follow_ == Follow::kYes) channels.emplace_back("MOUNT_CHECK");
  return channels;
}

Messages FuserNode::Handle(const Message& message) {
  if (const auto* text = std::get_if<RigText>(&message)) {
    OnRig(*text);
    return {};
  }
  if (!rig_) throw InputError("no rig heard yet; start rgbdt-session, or publish RIG");
  if (const auto* chunk = std::get_if<CloudChunk>(&message)) return OnChunk(*chunk);
  if (const auto* calibration = std::get_if<CalibrationMessage>(&message)) {
    return OnCalibration(*calibration);
  }
  if (const auto* check = std::get_if<MountCheck>(&message)) return OnMountCheck(*check);
  if (const auto* image = std::get_if<Image>(&message)) {
    OnImage(*image);
  } else if (const auto* pose = std::get_if<StampedPose>(&message)) {
    OnPose(*pose);
    return FuseDue();
  }
  return {};
}

Messages FuserNode::Advance(Utime now) {
  chunks_.Advance(now);
  return FuseDue();
}

void FuserNode::OnRig(const RigText& text) {
  if (rig_ && rig_->hash == text.hash) return;
  Rig rig = ParseRig(text.text, "RIG message");
  fuser_ = SweepFuser(rig.cameras, rig.lidar.range_sigma_m);
  rig_before_ = std::exchange(rig_, std::move(rig));
  against_.clear();
  follower_.Clear();
  chunks_.Clear();
  UpdateRangeCorrection();
  newest_image_.clear();
}

std::size_t FuserNode::IndexOf(const std::string& camera) const {
  const CameraSpec& spec = rig_->Camera(camera);  // throws with the names that there are
  return static_cast<std::size_t>(&spec - rig_->cameras.data());
}

void FuserNode::OnImage(const Image& image) {
  FusionCamera& camera = fuser_->camera(IndexOf(image.camera));
  if (image.shutter_correcting) {
    ++shutter_frames_;
    return;
  }
  PreparedImage prepared = Prepare(camera.spec(), image);
  Utime& newest = newest_image_[image.camera];
  if (image.utime < newest - kClockReset) {
    camera.ForgetImages();
    newest = 0;
  }
  newest = std::max(newest, image.utime);
  camera.AddImage(std::move(prepared),
                  chunks_.empty() ? FusionCamera::Full::kDropOldest : FusionCamera::Full::kThin);
}

void FuserNode::OnPose(const StampedPose& pose) {
  const auto added = fuser_->AddPose(pose);
  if (added != PoseTrack::Added::kOld) chunks_.OnPose(pose);
  switch (added) {
    case PoseTrack::Added::kYes:
      break;
    case PoseTrack::Added::kOld:
      ++old_poses_;
      break;
    case PoseTrack::Added::kJump:
      ++pose_jumps_;
      Warn("POSE of " + pose.source + " jumps to (" +
           std::to_string(pose.map_from_lidar.translation.x()) + ", " +
           std::to_string(pose.map_from_lidar.translation.y()) + ", " +
           std::to_string(pose.map_from_lidar.translation.z()) +
           ") m, faster than any rig moves; what was seen before it is given up");
  }
}

// What speaks against a camera's newest calibration, or nothing; told once.
void FuserNode::Tell(const std::string& camera, const std::vector<std::string>& against) {
  if (against.empty()) {
    against_.erase(camera);
    return;
  }
  const std::string prefix = use_ == Use::kAnyway ? "used anyway: " : "";
  std::string text;
  for (const std::string& why : against) {
    if (!text.empty()) text += "; ";
    text += prefix;
    text += why;
  }
  if (std::exchange(against_[camera], text) != text) Warn(text);
}

Messages FuserNode::OnCalibration(const CalibrationMessage& message) {
  const std::size_t camera = IndexOf(message.calibration.camera);
  std::vector<std::string> against =
      RequireRigOf(message, *rig_, rig_before_ ? &*rig_before_ : nullptr, use_);
  const std::string why = WhyNotToUse(message.calibration);
  if (!why.empty()) against.push_back(why);
  Tell(message.calibration.camera, against);
  if (!why.empty() && use_ == Use::kIfSound) return {};
  if (!follower_.Take(message.calibration, message.utime)) return {};
  std::vector<RgbdtCloud> parts =
      fuser_->SetCalibration(camera, message.calibration, message.utime);
  UpdateRangeCorrection();
  return MessagesOf(std::move(parts));
}

Messages FuserNode::OnMountCheck(const MountCheck& check) {
  const std::size_t camera = IndexOf(check.camera);
  if (follow_ == Follow::kNo) return {};
  std::string said;
  const auto step = follower_.Follow(fuser_->camera(camera).spec(), check, &said);
  if (!said.empty()) Warn(said);
  if (!step) return {};
  return MessagesOf(fuser_->SetCalibration(camera, step->calibration, step->utime));
}

bool FuserNode::calibrated() const {
  for (std::size_t i = 0; fuser_ && i < fuser_->cameras(); ++i) {
    if (fuser_->camera(i).calibrated) return true;
  }
  return false;
}

void FuserNode::UpdateRangeCorrection() {
  if (ranges_ == Ranges::kAsMeasured) return;
  std::vector<std::optional<RangeErrors>> of_cameras;
  for (std::size_t i = 0; i < fuser_->cameras(); ++i) {
    const FusionCamera& camera = fuser_->camera(i);
    if (camera.calibrated) of_cameras.push_back(camera.range_errors);
  }
  range_correction_ = RangeCorrectionFor(of_cameras);
}

// At a sweep's end: calibrations of one solve come one after the other.
void FuserNode::WarnOfRanges() {
  if (ranges_ == Ranges::kAsMeasured || !calibrated()) return;
  std::string warning;
  if (!range_correction_.errors) {
    warning =
        "--correct-ranges: the calibration has no range errors, clouds stay as measured; "
        "calibrate with this version and --method auto";
  } else if (range_correction_.cameras_differ) {
    warning =
        "--correct-ranges: cameras differ in their range errors, clouds are corrected by the "
        "first camera's; calibrate the cameras together";
  }
  if (!warning.empty() && warning != ranges_warning_) Warn(warning);
  ranges_warning_ = warning;
}

RgbdtCloud FuserNode::Fuse(const Cloud& cloud) {
  if (!range_correction_.errors) return fuser_->FuseChunk(cloud);
  return fuser_->FuseChunk(Corrected(cloud, *range_correction_.errors));
}

Messages FuserNode::OnChunk(const CloudChunk& chunk) {
  return chunks_.Keep(chunk) ? FuseDue() : FuseChunk(chunk);
}

Messages FuserNode::FuseDue() {
  Messages messages;
  while (const auto chunk = chunks_.Next()) {
    for (Message& part : FuseChunk(*chunk)) messages.push_back(std::move(part));
  }
  return messages;
}

Messages FuserNode::FuseChunk(const CloudChunk& chunk) {
  RgbdtCloud fused = Fuse(chunk.cloud);
  fused.sweep_end = chunk.sweep_end;
  // What served only points well before this chunk serves no more. A cloud from the future does not
  // take the present's images away.
  for (std::size_t i = 0; i < fuser_->cameras() && !fused.utime.empty(); ++i) {
    FusionCamera& camera = fuser_->camera(i);
    const Utime now = std::min(fused.utime.front(), newest_image_[camera.spec().name]);
    camera.ForgetBefore(now - kMicrosecondsPerSecond);
  }
  Messages messages = MessagesOf(PartsOf(std::move(fused), SweepFuser::kPartPoints));
  if (!chunk.sweep_end) return messages;
  WarnOfRanges();
  for (Message& part : MessagesOf(fuser_->EndSweep())) messages.push_back(std::move(part));
  return messages;
}

Status FuserNode::GetStatus() const {
  Status status;
  status.ready = rig_.has_value();
  status.text = !rig_                      ? "waits for the rig (RIG)"
                : !calibrated()            ? "no calibration yet: clouds go out without colour"
                : range_correction_.errors ? "fusing, ranges corrected"
                                           : "fusing";
  for (const auto& [camera, why] : against_) status.text += "; " + why;
  if (const std::string followed = follower_.Text(); !followed.empty()) {
    status.text += "; " + followed;
  }
  if (!chunks_.empty()) status.text += "; clouds wait for their POSE, which odometry tells later";
  const FusionCounts counts = fuser_ ? fuser_->counts() : FusionCounts();
  status.counters = {{"points", counts.points},
                     {"coloured", counts.coloured},
                     {"occluded", counts.occluded},
                     {"without an image of their time", counts.without_image},
                     {"without a pose", counts.without_pose},
                     {"shutter frames", shutter_frames_},
                     {"chunks that wait for a pose", static_cast<std::int64_t>(chunks_.size())},
                     {"pose jumps", pose_jumps_},
                     {"old poses", old_poses_}};
  return status;
}

}  // namespace rgbdt
