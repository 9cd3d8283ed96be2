#include "services/replay/drive_session.h"

#include <algorithm>
#include <cstdio>
#include <deque>
#include <optional>
#include <utility>

#include "calib/files/schema/calibration_file.h"
#include "calib/files/schema/rig_file.h"
#include "calib/files/session/session_dir.h"
#include "calib/model/errors.h"
#include "services/bus/log.h"
#include "services/messages/codec.h"
#include "services/messages/image_channel.h"
#include "services/nodes/assembler_node.h"
#include "services/nodes/odometry_node.h"
#include "services/nodes/shot_collector.h"
#include "services/replay/poses_ahead.h"

namespace rgbdt {
namespace {

double ShareRead(const LogReader& reader) {
  return static_cast<double>(reader.position()) /
         static_cast<double>(std::max<std::int64_t>(1, reader.size()));
}

// Whether a rig whose place is known to some millimetres was anywhere else than at its first pose.
bool Moves(const std::vector<StampedPose>& way) {
  constexpr double kPlaceM = 0.05, kTurnRad = 0.01;
  return std::any_of(way.begin(), way.end(), [&](const StampedPose& pose) {
    const Rigid3& first = way.front().map_from_lidar;
    return (pose.map_from_lidar.translation - first.translation).norm() > kPlaceM ||
           RotationDistance(pose.map_from_lidar, first) > kTurnRad;
  });
}

// Between sweeps that lie farther apart nobody knows how the rig moved: it may have stood for each.
bool IsDense(const std::vector<StampedPose>& way) {
  constexpr Utime kApart = kMicrosecondsPerSecond / 4;
  std::size_t near = 0;
  for (std::size_t i = 1; i < way.size(); ++i) {
    near += way[i].utime - way[i - 1].utime <= kApart ? 1 : 0;
  }
  return 2 * near > way.size();
}

struct WayOfSweeps {
  std::vector<StampedPose> poses;  // empty: nothing tells, or it is one place
  bool unknown = false;
  std::vector<std::string> problems;  // a line each
};

// Where the rig was, by the sweeps of a spinning LIDAR with times; of a log that has POSE nothing.
// What cannot be read is counted by who cuts.
WayOfSweeps FindWay(const std::string& log, const std::function<void(double)>& progress) {
  LogReader reader(log);
  OdometryNode odometry;
  WayOfSweeps found;
  bool timeless = false;  // sweeps whose points have no times
  std::vector<StampedPose>& way = found.poses;
  while (const auto event = reader.Next()) {
    if (progress) progress(ShareRead(reader));
    if (event->channel == "POSE") return {};
    if (event->channel != "CLOUD" && event->channel != "RIG") continue;
    try {
      const Message message = Decode(event->channel, event->bytes.data(), event->bytes.size());
      const auto* rig = std::get_if<RigText>(&message);
      if (rig != nullptr && ParseRig(rig->text, "RIG").lidar.turned_scanner) return {};
      const auto* chunk = std::get_if<CloudChunk>(&message);
      timeless |= chunk != nullptr && chunk->cloud.size() > 0 && chunk->cloud.utime.empty();
      if (timeless) continue;  // is there POSE?
      for (const Message& answer : odometry.Handle(message)) {
        if (const auto* pose = std::get_if<StampedPose>(&answer)) way.push_back(*pose);
      }
    } catch (const InputError&) {
      continue;
    }
  }
  std::int64_t sweeps = 0;
  for (const auto& [name, count] : odometry.GetStatus().counters) {
    if (name == "sweeps") sweeps = count;
    // The first sweep of each map has none.
    if (count == 0 || (name == "without a place" && count < 2)) continue;
    const bool tells =
        name == "without a place" || name == "degenerate" || name == "maps begun anew";
    if (tells) {
      found.problems.push_back(
          "the motion by the sweeps, as the log has no POSE: " + std::to_string(count) + " of " +
          std::to_string(sweeps) + " " + name);
    }
  }
  if (timeless || (!way.empty() && !IsDense(way))) way.clear();
  if ((sweeps < 2 && !timeless) || (!way.empty() && !Moves(way))) return {};
  if (!way.empty()) return found;
  found.unknown = true;
  found.problems = {"neither POSE nor the sweeps tell how the rig moved: it is taken to stand"};
  return found;
}

class Cutter {
 public:
  /// `way`: where the rig was, of a log without POSE; empty: not known, or at one place.
  Cutter(std::filesystem::path dir, const CutOptions& options, const std::vector<StampedPose>& way)
      : dir_(std::move(dir)), options_(options), poses_(way) {}

  void Take(const Message& message) {
    if (const auto* text = std::get_if<RigText>(&message)) {
      OnRig(*text);
    } else if (rig_) {  // it comes once a second
      TakeOfRig(message);
    }
  }

  // Writes what belongs to all of the sweeps.
  CutDrive Finish(const std::string& log) {
    if (!rig_) throw InputError(log + ": no RIG in this log; record that channel, too");
    if (taken_.empty()) {
      throw InputError(log + ": no sweep with an image of its time; of " + std::to_string(sweeps_) +
                       " sweeps none could be used. CLOUD (or LINE_SCAN and ENCODER) and the "
                       "cameras' images are needed, and POSE where it is there must tell where the "
                       "rig was");
    }
    if (!calibration_.cameras.empty()) {
      calibration_.sensors = SensorsOf(*rig_);
      WriteCalibration(dir_ / "calibration.textproto", calibration_);
    }
    CutDrive cut;
    cut.sweeps = taken_.size();
    for (const Taken& taken : taken_) cut.views += taken.cameras.size();
    return cut;
  }

 private:
  struct Taken {
    int number = 0;
    std::vector<std::string> cameras;
  };

  void TakeOfRig(const Message& message) {
    if (const auto* image = std::get_if<Image>(&message)) {
      const CameraCalibration* found = calibration_.Find(image->camera);
      shots_.Add(*image, found != nullptr ? found->timing : std::nullopt);
    } else if (const auto* pose = std::get_if<StampedPose>(&message)) {
      shots_.Add(*pose);
    } else if (const auto* calibration = std::get_if<CalibrationMessage>(&message)) {
      OnCalibration(*calibration);
    } else if (const auto* chunk = std::get_if<CloudChunk>(&message)) {
      if (!has_lines_) OnChunk(*chunk);
    } else if (rig_->lidar.turned_scanner) {
      has_lines_ |= std::holds_alternative<LineScan>(message);
      Assemble(message);
    }
  }

  void OnRig(const RigText& text) {
    if (rig_ && rig_->hash == text.hash) return;
    if (rig_) throw InputError("another RIG than the first one; it is left out");
    rig_ = ParseRig(text.text, "RIG");
    if (rig_->lidar.turned_scanner) assembler_.Handle(text);
    WriteRig(dir_, *rig_);
  }

  void OnCalibration(const CalibrationMessage& message) {
    if (message.rig_hash != rig_->hash) return;
    calibration_.method = message.method;
    calibration_.rig_hash = message.rig_hash;
    calibration_.utime = std::max(calibration_.utime, message.utime);
    for (CameraCalibration& camera : calibration_.cameras) {
      if (camera.camera != message.calibration.camera) continue;
      camera = message.calibration;
      return;
    }
    calibration_.cameras.push_back(message.calibration);
  }

  void Assemble(const Message& message) {
    for (const Message& chunk : assembler_.Handle(message)) {
      if (const auto* cloud = std::get_if<CloudChunk>(&chunk)) OnChunk(*cloud);
    }
  }

  void OnChunk(const CloudChunk& chunk) {
    const Utime name = chunk.cloud.sweep_utime;
    poses_.Until(NewestOf(chunk.cloud), [&](const StampedPose& pose) { shots_.Add(pose); });
    if (!shots_.Add(chunk)) return;
    ++sweeps_;
    if (due_ == 0) due_ = name;
    if (name < due_) return;
    const std::optional<Cloud> sweep = shots_.Complete(name);
    // While the rig moves a sweep with an image of its own time, unless none comes for as long
    // again: what hides what is as the sweep has it.
    if (!sweep) return;
    const bool waits = shots_.has_poses() && !sweep->utime.empty() && name < due_ + options_.every;
    if (Write(*sweep, waits)) due_ = name + options_.every;
    if (taken_.size() > options_.most_sweeps) Thin();
  }

  Rigid3 PoseOf(const CameraSpec& camera) const {
    const CameraCalibration* found = calibration_.Find(camera.name);
    if (found != nullptr) return found->camera_from_lidar;
    return camera.camera_from_lidar_guess.value_or(Rigid3());
  }

  static std::string NameOf(int number, const std::string& camera) {
    char digits[16];
    std::snprintf(digits, sizeof(digits), "%04d", number);
    return digits + ("-" + camera);
  }

  // `own_time`: only of cameras whose image was taken while it was swept.
  bool Write(const Cloud& sweep, bool own_time) {
    std::vector<std::pair<std::string, TakenShot>> shots;
    for (const CameraSpec& camera : rig_->cameras) {
      std::optional<TakenShot> shot = shots_.ShotOf(sweep, camera, PoseOf(camera));
      if (!shot) continue;
      if (own_time && (shot->taken < sweep.sweep_utime || shot->taken > NewestOf(sweep))) continue;
      shots.emplace_back(camera.name, std::move(*shot));
    }
    if (shots.empty()) return false;
    Taken taken;
    taken.number = ++number_;
    for (auto& [camera, shot] : shots) {
      View view;
      view.name = NameOf(taken.number, camera);
      view.heldout = taken.number % 3 == 0;
      view.cloud = std::move(shot.cloud);
      view.map_from_lidar = shot.map_from_lidar;
      view.images.push_back(std::move(shot.image));
      WriteView(dir_, view);
      taken.cameras.push_back(camera);
    }
    taken_.push_back(std::move(taken));
    return true;
  }

  // Every second one goes. Of those that stay every third is held out still: 1 3 5 7 9 11.
  void Thin() {
    std::deque<Taken> kept;
    for (std::size_t i = 0; i < taken_.size(); ++i) {
      if (i % 2 == 0) {
        kept.push_back(taken_[i]);
        continue;
      }
      for (const std::string& camera : taken_[i].cameras) {
        std::filesystem::remove_all(dir_ / "views" / NameOf(taken_[i].number, camera));
      }
    }
    taken_ = std::move(kept);
    options_.every *= 2;
  }

  std::filesystem::path dir_;
  CutOptions options_;
  PosesAhead poses_;
  std::optional<Rig> rig_;
  AssemblerNode assembler_;
  ShotCollector shots_;
  Calibration calibration_;
  bool has_lines_ = false;
  Utime due_ = 0;  // name of the next sweep that is taken; 0: the first
  std::size_t sweeps_ = 0;
  int number_ = 0;
  std::deque<Taken> taken_;
};

bool IsOfUse(const std::string& channel) {
  return channel == "RIG" || channel == "CLOUD" || channel == "LINE_SCAN" || channel == "ENCODER" ||
         channel == "POSE" || channel == "CALIBRATION" || IsImageChannel(channel);
}

}  // namespace

CutDrive CutIntoSession(const std::string& log, const std::filesystem::path& dir,
                        const CutOptions& options, const std::function<void(double)>& progress) {
  const auto part = [&](double from) {
    return [&progress, from](double share) {
      if (progress) progress(from + 0.5 * share);
    };
  };
  const WayOfSweeps way = FindWay(log, part(0));
  LogReader reader(log);
  Cutter cutter(dir, options, way.poses);
  std::size_t dropped = 0;
  std::string last_problem;
  while (const auto event = reader.Next()) {
    if (!IsOfUse(event->channel)) continue;
    try {
      cutter.Take(Decode(event->channel, event->bytes.data(), event->bytes.size()));
    } catch (const InputError& error) {  // as a process does: dropped and counted
      ++dropped;
      last_problem = event->channel + ": " + error.what();
    }
    part(0.5)(ShareRead(reader));
  }
  CutDrive cut = cutter.Finish(log);
  cut.by_odometry = !way.poses.empty();
  cut.motion_unknown = way.unknown;
  cut.problems = way.problems;
  if (dropped > 0) {
    cut.problems.push_back(std::to_string(dropped) +
                           " messages dropped; the last: " + last_problem);
  }
  if (reader.unreadable_bytes() > 0) {
    cut.problems.push_back(std::to_string(reader.unreadable_bytes()) +
                           " bytes belong to no whole message; was the logger killed?");
  }
  return cut;
}

}  // namespace rgbdt
