#include "services/replay/drive_map.h"

#include <algorithm>
#include <cstdio>
#include <functional>
#include <optional>
#include <utility>

#include "calib/fuse/sweep_fuser.h"
#include "calib/model/errors.h"
#include "services/bus/log.h"
#include "services/messages/codec.h"
#include "services/messages/image_channel.h"
#include "services/messages/status_counters.h"
#include "services/nodes/fuser_node.h"
#include "services/nodes/odometry_node.h"
#include "services/replay/poses_ahead.h"

namespace rgbdt {
namespace {

/// The log's messages on some channels, one after the other; broken ones are counted.
class Reader {
 public:
  /// `known`: channels of which broken messages were counted before.
  Reader(const std::string& path, MappedDrive* drive, std::function<bool(const std::string&)> known)
      : log_(path), drive_(drive), known_(std::move(known)) {}

  template <typename Wanted, typename Take>
  void Each(const Wanted& wanted, const Take& take, const std::function<void(double)>& progress) {
    while (const auto event = log_.Next()) {
      if (progress) {
        progress(static_cast<double>(log_.position()) / static_cast<double>(log_.size()));
      }
      if (!wanted(event->channel)) continue;
      Message message;
      try {
        message = Decode(event->channel, event->bytes.data(), event->bytes.size());
      } catch (const std::exception& e) {
        if (!known_(event->channel)) Drop(e);
        continue;
      }
      try {
        take(message);
      } catch (const std::exception& e) {
        Drop(e);
      }
    }
    drive_->unreadable_bytes = log_.unreadable_bytes();
  }

 private:
  void Drop(const std::exception& error) {
    ++drive_->dropped;
    drive_->last_problem = error.what();
  }

  LogReader log_;
  MappedDrive* drive_;
  std::function<bool(const std::string&)> known_;
};

// Read for the way; what is broken there is counted then.
bool IsOfWay(const std::string& channel) {
  return channel == "CLOUD" || channel == "POSE" || channel == "RIG";
}

bool IsOnePlace(const StampedPose& a, const StampedPose& b) {
  return a.map_from_lidar.translation == b.map_from_lidar.translation &&
         a.map_from_lidar.rotation.coeffs() == b.map_from_lidar.rotation.coeffs();
}

void Correct(const Keyframes& keyframes, const LoopColours& colours, MappedDrive* drive) {
  drive->closed = CloseLoops(keyframes, colours);
  const std::vector<StampedPose> found = drive->way;
  for (std::size_t i = 0; i < found.size(); ++i) {
    // A stop's poses are one place, corrected as of its middle.
    std::size_t last = i;
    while (last + 1 < found.size() && IsOnePlace(found[i], found[last + 1])) ++last;
    const Utime middle = found[i].utime + (found[last].utime - found[i].utime) / 2;
    const Rigid3 corrected = drive->closed->Corrected(middle, found[i].map_from_lidar);
    for (; i < last; ++i) drive->way[i].map_from_lidar = corrected;
    drive->way[last].map_from_lidar = corrected;
  }
}

/// What the cameras saw along the way that odometry finds; what is broken is told by the second
/// reading.
class WayColours {
 public:
  void Take(const Message& message) {
    try {
      for (const Message& fused : fuser_.Handle(message)) Add(fused);
    } catch (const std::exception&) {  // nothing is seen by it
    }
  }
  /// What waits for poses that do not come is seen without them, as far as it can be.
  void Finish() {
    for (const Utime now : {Utime{0}, 1000 * kMicrosecondsPerSecond}) {
      for (const Message& fused : fuser_.Advance(now)) Add(fused);
    }
  }
  const LoopColours& colours() const { return colours_; }

 private:
  void Add(const Message& fused) {
    if (const auto* cloud = std::get_if<RgbdtCloud>(&fused)) colours_.Add(*cloud);
  }

  FuserNode fuser_;
  LoopColours colours_;
};

bool IsOfColours(const std::string& channel) {
  return channel == "CALIBRATION" || IsImageChannel(channel);
}

// The log's own poses, or else those of the sweeps; the log's first rig, if it has one.
std::optional<RigText> FindWay(const std::string& log, const DriveOptions& options,
                               MappedDrive* drive, const std::function<void(double)>& progress) {
  Keyframes keyframes;
  WayColours colours;
  OdometryNode odometry({}, [&](const Cloud& sweep, const OdometryResult& found_there) {
    if (options.close_loops) keyframes.Add(sweep, found_there);
  });
  std::vector<StampedPose> own, found;
  std::optional<RigText> rig;
  Reader(log, drive, IsOfColours)
      .Each(
          [&](const std::string& channel) {
            return IsOfWay(channel) || (options.close_loops && IsOfColours(channel));
          },
          [&](const Message& message) {
            if (const auto* text = std::get_if<RigText>(&message); text != nullptr && !rig) {
              rig = *text;
            }
            if (const auto* pose = std::get_if<StampedPose>(&message);
                pose != nullptr && !options.close_loops) {
              own.push_back(*pose);
            }
            if (!own.empty()) return;
            for (const Message& answer : odometry.Handle(message)) {
              const auto* pose = std::get_if<StampedPose>(&answer);
              if (pose == nullptr) continue;
              found.push_back(*pose);
              if (options.close_loops) colours.Take(*pose);
            }
            // By odometry's poses alone.
            const bool pose = std::holds_alternative<StampedPose>(message);
            if (options.close_loops && !pose) colours.Take(message);
          },
          progress);
  colours.Finish();
  drive->by_odometry = own.empty();
  drive->way = own.empty() ? std::move(found) : std::move(own);
  if (options.close_loops && !drive->way.empty()) Correct(keyframes, colours.colours(), drive);
  if (drive->by_odometry) {
    const Status status = odometry.GetStatus();
    drive->sweeps = CounterOf(status, "sweeps");
    drive->without_place = CounterOf(status, "without a place");
    drive->degenerate = CounterOf(status, "degenerate");
    drive->restarts = CounterOf(status, "maps begun anew");
  }
  return rig;
}

}  // namespace

MappedDrive MapDrive(const std::string& log, MapperNode* mapper, const DriveOptions& options) {
  const auto part = [&](double from) {
    return [&options, from](double share) {
      if (options.progress) options.progress(from + 0.5 * share);
    };
  };
  MappedDrive drive;
  const std::optional<RigText> rig = FindWay(log, options, &drive, part(0));
  const bool has_rig = rig.has_value();
  if (drive.way.empty()) {
    throw InputError(log + ": it has no POSE, and of its " + std::to_string(drive.sweeps) +
                     " sweeps (CLOUD) none whose place was found" +
                     (drive.last_problem.empty() ? "" : "; last problem: " + drive.last_problem));
  }
  FuserNode fuser;
  SweepFuser plain({}, 0.01);
  // A rig comes once a second: sweeps before the first one would be without.
  if (rig) fuser.Handle(*rig);
  PosesAhead poses(drive.way);
  const auto map = [&](const Message& fused) {
    const auto* cloud = std::get_if<RgbdtCloud>(&fused);
    // A sweep comes once more at its end; and what no pose tells lies nowhere.
    if (ChannelOf(fused) != "RGBDT_CLOUD" || !cloud->map_from_lidar) return;
    mapper->Handle(fused);
    ++drive.clouds;
  };
  Reader(log, &drive, IsOfWay)
      .Each(
          [has_rig](const std::string& channel) {
            return channel == "CLOUD" ||
                   (has_rig &&
                    (channel == "RIG" || channel == "CALIBRATION" || IsImageChannel(channel)));
          },
          [&](const Message& message) {
            if (const auto* chunk = std::get_if<CloudChunk>(&message)) {
              poses.Until(NewestOf(chunk->cloud), [&](const StampedPose& pose) {
                if (has_rig) {
                  for (const Message& fused : fuser.Handle(pose)) map(fused);
                } else {
                  plain.AddPose(pose);
                }
              });
              if (!has_rig) {
                map(plain.FuseChunk(chunk->cloud));
                return;
              }
            }
            for (const Message& fused : fuser.Handle(message)) map(fused);
          },
          part(0.5));
  return drive;
}

std::string TumText(const std::vector<StampedPose>& way) {
  std::string text = "# time [s, UTC] tx ty tz [m] qx qy qz qw: world_from_lidar\n";
  for (const StampedPose& pose : way) {
    const Eigen::Vector3d& t = pose.map_from_lidar.translation;
    const Eigen::Quaterniond& q = pose.map_from_lidar.rotation;
    char line[300];
    std::snprintf(line, sizeof line, "%lld.%06lld %.6f %.6f %.6f %.9f %.9f %.9f %.9f\n",
                  static_cast<long long>(pose.utime / kMicrosecondsPerSecond),
                  static_cast<long long>(pose.utime % kMicrosecondsPerSecond), t.x(), t.y(), t.z(),
                  q.x(), q.y(), q.z(), q.w());
    text += line;
  }
  return text;
}

}  // namespace rgbdt
