#include "services/foxglove/stream/foxglove_stream.h"

#include <google/protobuf/descriptor.pb.h>

#include <algorithm>
#include <memory>
#include <utility>
#include <variant>

#include "calib/files/schema/rig_file.h"
#include "calib/model/errors.h"
#include "services/foxglove/stream/foxglove_messages.h"

namespace rgbdt {
namespace {

constexpr std::size_t kMostNames = 1000;  // of processes and cameras: a stranger's fill no memory

// Points of another pose into the frame of `cloud`.
void Append(RgbdtCloud more, RgbdtCloud* cloud) {
  if (cloud->map_from_lidar && more.frame_utime != cloud->frame_utime) {
    const Rigid3 here_from_there = cloud->map_from_lidar->Inverse() * *more.map_from_lidar;
    for (Eigen::Vector3f& point : more.points) {
      point = (here_from_there * point.cast<double>()).cast<float>();
    }
  }
  const auto append = [](const auto& from, auto* to) {
    to->insert(to->end(), from.begin(), from.end());
  };
  append(more.points, &cloud->points);
  append(more.intensity, &cloud->intensity);
  append(more.utime, &cloud->utime);
  append(more.rgb, &cloud->rgb);
  append(more.temperature_k, &cloud->temperature_k);
  append(more.temperature_sigma_k, &cloud->temperature_sigma_k);
  append(more.thermal_counts, &cloud->thermal_counts);
  append(more.valid, &cloud->valid);
}

// What was last said of a name; what it was before is given back.
std::string Exchange(std::map<std::string, std::string>* all, const std::string& name,
                     const std::string& text) {
  if (all->size() >= kMostNames && all->count(name) == 0) all->clear();
  return std::exchange((*all)[name], text);
}

}  // namespace

std::string DescribeSchema(const google::protobuf::Descriptor& type) {
  const google::protobuf::FileDescriptor& file = *type.file();
  google::protobuf::FileDescriptorSet set;
  for (int i = 0; i < file.dependency_count(); ++i) file.dependency(i)->CopyTo(set.add_file());
  file.CopyTo(set.add_file());
  return set.SerializeAsString();
}

FoxgloveStream::FoxgloveStream(Options options, Sink sink)
    : frames_(std::move(options.frames)),
      sink_(std::move(sink)),
      now_(options.start),
      lidar_(frames_.lidar.empty() ? options.lidar : frames_.lidar),
      fused_sweeps_(options.fused_sweeps) {}

void FoxgloveStream::Take(const Message& message, const Bytes& image_file) {
  now_ = std::max(now_, UtimeOf(message));
  if (const auto* image = std::get_if<Image>(&message)) return TakeImage(*image, image_file);
  std::visit([this](const auto& m) { On(m); }, message);
}

void FoxgloveStream::Finish() {
  FlushFused();
  ForgetUnended();
}

template <typename M>
void FoxgloveStream::Put(const std::string& topic, const M& message, Utime sent,
                         const std::string& holds_for) {
  sink_({topic, M::descriptor(), now_, sent > 0 ? sent : now_, holds_for, false,
         [message] { return message.SerializeAsString(); }});
}

template <typename Data>
void FoxgloveStream::PutLarge(const std::string& topic, Data data, const std::string& frame,
                              Utime sent) {
  using M = decltype(ToFoxglove(data, frame));
  const auto shared = std::make_shared<const Data>(std::move(data));
  sink_({topic, M::descriptor(), now_, sent > 0 ? sent : now_, "", true,
         [shared, frame] { return ToFoxglove(*shared, frame).SerializeAsString(); }});
}

std::string FoxgloveStream::FrameOf(const std::string& camera) const {
  const auto found = frames_.cameras.find(camera);
  return found == frames_.cameras.end() ? camera + "_optical_frame" : found->second;
}

void FoxgloveStream::On(const CloudChunk& chunk) {
  const Utime name = chunk.cloud.sweep_utime;
  sweeps_.Add(chunk);
  if (under_way_.size() >= SweepCollector::kMaxSweeps) ForgetUnended();
  under_way_.insert(name);
  if (!chunk.sweep_end) return;
  std::optional<Cloud> sweep = sweeps_.Complete(name);
  if (!sweeps_.WhyTorn(name).empty()) ++torn_sweeps_;
  sweeps_.Clear();  // it would keep many
  under_way_.erase(name);
  ForgetUnended();
  if (sweep && sweep->size() > 0) PutLarge("/lidar/points", std::move(*sweep), lidar_);
}

void FoxgloveStream::ForgetUnended() {
  torn_sweeps_ += static_cast<std::int64_t>(under_way_.size());
  under_way_.clear();
}

void FoxgloveStream::On(const RgbdtCloud& cloud) {
  constexpr std::size_t kMostPoints = 2'000'000;  // of a message: 90 MB
  fused_sweeps_ |= cloud.whole_sweep;
  if (!cloud.whole_sweep && fused_sweeps_) return;
  const bool joins = fused_ && fused_->sweep_utime == cloud.sweep_utime &&
                     fused_->cameras == cloud.cameras &&
                     fused_->map_from_lidar.has_value() == cloud.map_from_lidar.has_value() &&
                     fused_->size() + cloud.size() <= kMostPoints;
  if (!joins) FlushFused();
  if (fused_) {
    Append(cloud, &*fused_);
  } else {
    fused_ = cloud;
  }
  if (cloud.sweep_end) FlushFused();
}

void FoxgloveStream::FlushFused() {
  std::optional<RgbdtCloud> fused = std::exchange(fused_, std::nullopt);
  if (fused && fused->size() > 0) PutLarge("/fused/points", std::move(*fused), lidar_);
}

void FoxgloveStream::TakeImage(const Image& image, const Bytes& file) {
  const std::string topic = "/" + image.camera + "/image_raw", frame = FrameOf(image.camera);
  if (file.empty()) return PutLarge(topic, image, frame, image.utime);
  PutLarge(topic + "/compressed", ImageFile{file, image.utime}, frame, image.utime);
}

void FoxgloveStream::On(const StampedPose& pose) {
  foxglove::FrameTransforms transforms;
  *transforms.add_transforms() = ToFoxglove(pose.map_from_lidar, kMapFrame, lidar_, pose.utime);
  Put("/tf", transforms, pose.utime);
  Put("/pose", ToFoxglove(pose), pose.utime);
}

void FoxgloveStream::On(const RigText& rig) {
  if (!rig_ || rig_->hash != rig.hash) {
    rig_ = ParseRig(rig.text, "RIG", LensNeed::kMayBeUnknown);
    if (frames_.lidar.empty() && !rig_->lidar.name.empty()) lidar_ = rig_->lidar.name;
    for (auto solved = calibrations_.begin(); solved != calibrations_.end();) {
      solved = solved->second.rig_hash == rig.hash ? ++solved : calibrations_.erase(solved);
    }
  }
  for (const CameraSpec& camera : rig_->cameras) {
    PutLens(camera);
    const auto& guess = camera.camera_from_lidar_guess;
    if (guess && calibrations_.count(camera.name) == 0) PutCamera(camera.name, *guess);
  }
}

void FoxgloveStream::PutLens(const CameraSpec& camera) {
  const auto solved = calibrations_.find(camera.name);
  const CameraSpec with_lens =
      solved == calibrations_.end() ? camera : solved->second.calibration.WithSolvedLens(camera);
  if (!with_lens.lens.known()) return;
  Put("/" + camera.name + "/camera_info", ToFoxglove(with_lens, now_, FrameOf(camera.name)), 0,
      camera.name);
}

void FoxgloveStream::PutCamera(const std::string& camera, const Rigid3& camera_from_lidar,
                               Utime sent) {
  foxglove::FrameTransforms transforms;
  *transforms.add_transforms() =
      ToFoxglove(camera_from_lidar.Inverse(), lidar_, FrameOf(camera), now_);
  Put("/tf_static", transforms, sent, camera);
}

void FoxgloveStream::On(const CalibrationMessage& message) {
  const CameraCalibration& calibration = message.calibration;
  if (rig_ && rig_->hash != message.rig_hash) {
    throw InputError("the calibration of " + calibration.camera +
                     " was made with another rig than the log's");
  }
  if (!calibration.converged()) {
    const std::string text = calibration.camera + ": " + calibration.StatusText();
    if (Exchange(&not_used_, calibration.camera, text) != text) {
      Put("/events", ToLog(foxglove::Log::WARNING, "solver", text, now_));
    }
    return;
  }
  if (calibrations_.size() >= kMostNames) calibrations_.clear();
  calibrations_[calibration.camera] = message;
  PutCamera(calibration.camera, calibration.camera_from_lidar, message.utime);
}

void FoxgloveStream::On(const Status& status) {
  const std::string before = Exchange(&problems_, status.process, status.last_problem);
  const bool is_new = !status.last_problem.empty() && status.last_problem != before;
  std::string text = status.text;
  if (is_new) text += (text.empty() ? "" : "; ") + status.last_problem;
  Put("/status",
      ToLog(is_new ? foxglove::Log::WARNING : foxglove::Log::INFO, status.process, text, now_));
}

void FoxgloveStream::On(const SessionEvent& event) {
  const bool failed = event.kind == EventKind::kFailed;
  Put("/events",
      ToLog(failed ? foxglove::Log::ERROR : foxglove::Log::INFO, event.source, event.text, now_));
}

void FoxgloveStream::On(const MountCheck& check) {
  const bool well = check.state == MountState::kCannotTell || check.state == MountState::kHolds;
  Put("/mount_check",
      ToLog(well ? foxglove::Log::INFO : foxglove::Log::WARNING, check.camera, check.text, now_));
}

}  // namespace rgbdt
