#include "services/export/export_log.h"

#include <google/protobuf/descriptor.pb.h>

#include <algorithm>
#include <optional>
#include <set>
#include <utility>
#include <variant>

#include "calib/files/atomic_file.h"
#include "calib/files/schema/rig_file.h"
#include "calib/model/errors.h"
#include "calib/model/version.h"
#include "calib/scan_assembly/sweep_collector.h"
#include "services/bags/mcap_writer.h"
#include "services/bus/log.h"
#include "services/export/foxglove_messages.h"
#include "services/messages/codec.h"

namespace rgbdt {
namespace {

bool IsImages(const std::string& channel) {
  static const std::string kEnd = "_IMAGE";
  return channel.size() > kEnd.size() &&
         channel.compare(channel.size() - kEnd.size(), kEnd.size(), kEnd) == 0;
}

bool IsExported(const std::string& channel) {
  static const std::set<std::string> channels = {"CLOUD",       "RGBDT_CLOUD",   "RGBDT_SWEEP",
                                                 "CALIBRATION", "POSE",          "RIG",
                                                 "STATUS",      "SESSION_EVENT", "MOUNT_CHECK"};
  return channels.count(channel) != 0 || IsImages(channel);
}

Message DecodeEvent(const LogEvent& event) {
  return Decode(event.channel, event.bytes.data(), event.bytes.size());
}

// What must be known before the first message is written.
struct LogSurvey {
  Utime first = 0;         // sensor time; 0: there is none
  std::string lidar_name;  // of the first rig; empty: there is none
  bool fused_sweeps = false;
  std::map<std::string, std::int64_t> left_out;
};

LogSurvey SurveyLog(const std::string& path, const std::function<void(double)>& progress) {
  LogReader log(path);
  LogSurvey survey;
  while (const auto event = log.Next()) {
    if (progress) progress(0.5 * log.position() / static_cast<double>(log.size()));
    if (!IsExported(event->channel)) {
      ++survey.left_out[event->channel];
      continue;
    }
    survey.fused_sweeps |= event->channel == "RGBDT_SWEEP";
    const bool rig_wanted = survey.lidar_name.empty() && event->channel == "RIG";
    if (survey.first != 0 && !rig_wanted) continue;
    try {
      const Message message = DecodeEvent(*event);
      if (survey.first == 0) survey.first = UtimeOf(message);
      if (rig_wanted) {
        survey.lidar_name =
            ParseRig(std::get<RigText>(message).text, "RIG", LensNeed::kMayBeUnknown).lidar.name;
      }
    } catch (const std::exception&) {  // counted where it is to be written
    }
  }
  return survey;
}

// The disk fails: no matter of the message that was to be written.
struct WriteError : InputError {
  using InputError::InputError;
};

void WriteTo(AtomicFile* file, std::string_view bytes) {
  try {
    file->Write(bytes);
  } catch (const InputError& error) {
    throw WriteError(error.what());
  }
}

// A schema with all that it names, as MCAP wants it.
std::string DescribeFile(const google::protobuf::FileDescriptor& file) {
  google::protobuf::FileDescriptorSet set;
  for (int i = 0; i < file.dependency_count(); ++i) file.dependency(i)->CopyTo(set.add_file());
  file.CopyTo(set.add_file());
  return set.SerializeAsString();
}

// Topics of an MCAP, made as their first message comes.
class Topics {
 public:
  Topics(AtomicFile* file, ExportedLog* out)
      : out_(out),
        writer_([file](std::string_view bytes) { WriteTo(file, bytes); },
                std::string("rgbdt ") + Version()) {}

  template <typename M>
  void Put(const std::string& topic, const M& message, Utime log, Utime publish) {
    ExportedLog::Topic& of_topic = out_->topics[topic];
    const std::string& schema = M::descriptor()->full_name();
    if (of_topic.schema.empty()) {
      of_topic.schema = schema;
      channels_[topic] = writer_.AddChannel(topic, SchemaOf(*M::descriptor()), "protobuf");
    }
    writer_.Write(channels_.at(topic), log, publish, message.SerializeAsString());
    ++of_topic.messages;
  }
  void Finish() { writer_.Finish(); }

 private:
  std::uint16_t SchemaOf(const google::protobuf::Descriptor& type) {
    const auto found = schemas_.find(type.full_name());
    if (found != schemas_.end()) return found->second;
    const std::uint16_t id =
        writer_.AddSchema(type.full_name(), "protobuf", DescribeFile(*type.file()));
    schemas_[type.full_name()] = id;
    return id;
  }

  ExportedLog* out_;
  McapWriter writer_;
  std::map<std::string, std::uint16_t> schemas_, channels_;
};

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

class Exporter {
 public:
  Exporter(LogSurvey survey, const ExportFrames& frames, Topics* topics, ExportedLog* exported)
      : survey_(std::move(survey)),
        frames_(frames),
        topics_(topics),
        exported_(exported),
        now_(survey_.first) {
    lidar_ = !frames.lidar.empty()        ? frames.lidar
             : survey_.lidar_name.empty() ? "lidar"
                                          : survey_.lidar_name;
  }

  void Take(const LogEvent& event) {
    const Message message = DecodeEvent(event);
    now_ = std::max(now_, UtimeOf(message));
    if (const auto* image = std::get_if<Image>(&message)) {
      return TakeImage(*image, ImageFileOf(event.bytes.data(), event.bytes.size()));
    }
    std::visit([this](const auto& m) { Take(m); }, message);
  }

  void Finish() {
    FlushFused();
    ForgetUnended();
  }

 private:
  template <typename M>
  void Put(const std::string& topic, const M& message, Utime sent = 0) {
    topics_->Put(topic, message, now_, sent > 0 ? sent : now_);
  }

  template <typename M>
  void Take(const M& /*of no exported channel*/) {}

  std::string FrameOf(const std::string& camera) const {
    const auto found = frames_.cameras.find(camera);
    return found == frames_.cameras.end() ? camera + "_optical_frame" : found->second;
  }

  void Take(const CloudChunk& chunk) {
    const Utime name = chunk.cloud.sweep_utime;
    sweeps_.Add(chunk);
    if (under_way_.size() >= SweepCollector::kMaxSweeps) ForgetUnended();
    under_way_.insert(name);
    if (!chunk.sweep_end) return;
    const std::optional<Cloud> sweep = sweeps_.Complete(name);
    if (!sweeps_.WhyTorn(name).empty()) ++exported_->torn_sweeps;
    sweeps_.Clear();  // it would keep many
    under_way_.erase(name);
    ForgetUnended();
    if (sweep && sweep->size() > 0) Put("/lidar/points", ToFoxglove(*sweep, lidar_));
  }

  void ForgetUnended() {
    exported_->torn_sweeps += static_cast<std::int64_t>(under_way_.size());
    under_way_.clear();
  }

  void Take(const RgbdtCloud& cloud) {
    constexpr std::size_t kMostPoints = 2'000'000;  // of a message: 90 MB
    if (!cloud.whole_sweep && survey_.fused_sweeps) return;
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

  void FlushFused() {
    if (fused_ && fused_->size() > 0) Put("/fused/points", ToFoxglove(*fused_, lidar_));
    fused_.reset();
  }

  void TakeImage(const Image& image, const Bytes& file) {
    const std::string topic = "/" + image.camera + "/image_raw", frame = FrameOf(image.camera);
    if (file.empty()) return Put(topic, ToFoxglove(image, frame), image.utime);
    Put(topic + "/compressed", ToFoxglove(file, image.utime, frame), image.utime);
  }

  void Take(const StampedPose& pose) {
    foxglove::FrameTransforms transforms;
    *transforms.add_transforms() = ToFoxglove(pose.map_from_lidar, kMapFrame, lidar_, pose.utime);
    Put("/tf", transforms, pose.utime);
    Put("/pose", ToFoxglove(pose), pose.utime);
  }

  void Take(const RigText& rig) {
    if (!rig_ || rig_->hash != rig.hash) {
      rig_ = ParseRig(rig.text, "RIG", LensNeed::kMayBeUnknown);
      for (auto solved = calibrations_.begin(); solved != calibrations_.end();) {
        solved = solved->second.rig_hash == rig.hash ? ++solved : calibrations_.erase(solved);
      }
    }
    foxglove::FrameTransforms guesses;
    for (const CameraSpec& camera : rig_->cameras) {
      PutLens(camera);
      const auto& guess = camera.camera_from_lidar_guess;
      if (!guess || calibrations_.count(camera.name) != 0) continue;
      *guesses.add_transforms() = ToFoxglove(guess->Inverse(), lidar_, FrameOf(camera.name), now_);
    }
    if (guesses.transforms_size() > 0) Put("/tf_static", guesses);
  }

  void PutLens(const CameraSpec& camera) {
    const auto solved = calibrations_.find(camera.name);
    const CameraSpec with_lens =
        solved == calibrations_.end() ? camera : solved->second.calibration.WithSolvedLens(camera);
    if (!with_lens.lens.known()) return;
    Put("/" + camera.name + "/camera_info", ToFoxglove(with_lens, now_, FrameOf(camera.name)));
  }

  void Take(const CalibrationMessage& message) {
    const CameraCalibration& calibration = message.calibration;
    if (rig_ && rig_->hash != message.rig_hash) {
      throw InputError("the calibration of " + calibration.camera +
                       " was made with another rig than the log's");
    }
    if (!calibration.converged()) {
      std::string& said = not_used_[calibration.camera];
      const std::string text = calibration.camera + ": " + calibration.StatusText();
      if (std::exchange(said, text) != text) {
        Put("/events", ToLog(foxglove::Log::WARNING, "solver", text, now_));
      }
      return;
    }
    calibrations_[calibration.camera] = message;
    foxglove::FrameTransforms transforms;
    *transforms.add_transforms() = ToFoxglove(calibration.camera_from_lidar.Inverse(), lidar_,
                                              FrameOf(calibration.camera), now_);
    Put("/tf_static", transforms, message.utime);
  }

  void Take(const Status& status) {
    std::string& before = problems_[status.process];
    const bool is_new = !status.last_problem.empty() && status.last_problem != before;
    before = status.last_problem;
    std::string text = status.text;
    if (is_new) text += (text.empty() ? "" : "; ") + status.last_problem;
    Put("/status",
        ToLog(is_new ? foxglove::Log::WARNING : foxglove::Log::INFO, status.process, text, now_));
  }

  void Take(const SessionEvent& event) {
    const bool failed = event.kind == EventKind::kFailed;
    Put("/events",
        ToLog(failed ? foxglove::Log::ERROR : foxglove::Log::INFO, event.source, event.text, now_));
  }

  void Take(const MountCheck& check) {
    const bool well = check.state == MountState::kCannotTell || check.state == MountState::kHolds;
    Put("/mount_check",
        ToLog(well ? foxglove::Log::INFO : foxglove::Log::WARNING, check.camera, check.text, now_));
  }

  LogSurvey survey_;
  const ExportFrames& frames_;
  Topics* topics_;
  ExportedLog* exported_;
  Utime now_;
  std::string lidar_;
  SweepCollector sweeps_;
  std::set<Utime> under_way_;  // sweeps whose end has not come
  std::optional<RgbdtCloud> fused_;
  std::optional<Rig> rig_;
  std::map<std::string, CalibrationMessage> calibrations_;  // those to be used
  std::map<std::string, std::string> not_used_, problems_;
};

// Whether a name would be taken by who reads it.
void CheckFrames(const ExportFrames& frames) {
  std::set<std::string> names;
  const auto check = [&](const std::string& name) {
    const bool odd = name.empty() || std::any_of(name.begin(), name.end(), [](unsigned char c) {
                       return c <= ' ' || c >= 0x7f;
                     });
    if (odd) throw InputError("\"" + name + "\" is no name of a frame; expected no blanks");
    if (!names.insert(name).second) {
      throw InputError("the frame \"" + name + "\" twice; give each camera and the LIDAR its own");
    }
  };
  if (!frames.lidar.empty()) check(frames.lidar);
  for (const auto& [camera, frame] : frames.cameras) check(frame);
}

}  // namespace

ExportedLog ExportLog(const std::string& log_path, const std::filesystem::path& out,
                      const ExportFrames& frames, const std::function<void(double)>& progress) {
  CheckFrames(frames);
  const LogSurvey survey = SurveyLog(log_path, progress);
  LogReader log(log_path);
  ExportedLog exported;
  exported.left_out = survey.left_out;
  AtomicFile file(out);
  Topics topics(&file, &exported);
  Exporter exporter(survey, frames, &topics, &exported);
  while (const auto event = log.Next()) {
    if (progress) progress(0.5 + 0.5 * log.position() / static_cast<double>(log.size()));
    if (!IsExported(event->channel)) continue;
    try {
      exporter.Take(*event);
    } catch (const WriteError&) {
      throw;
    } catch (const std::exception& error) {
      ++exported.dropped;
      exported.last_problem = event->channel + ": " + error.what();
    }
  }
  exporter.Finish();
  exported.unreadable_bytes = log.unreadable_bytes();
  if (exported.topics.empty()) {
    throw InputError(log_path + ": holds nothing to export" +
                     (exported.last_problem.empty() ? "" : "; " + exported.last_problem));
  }
  topics.Finish();
  file.Commit();
  return exported;
}

}  // namespace rgbdt
