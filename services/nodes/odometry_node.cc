#include "services/nodes/odometry_node.h"

#include <optional>

#include "calib/model/pose_track.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

std::string Joined(const std::vector<std::string>& words) {
  std::string joined;
  for (const std::string& word : words) joined += (joined.empty() ? "" : ", ") + word;
  return joined;
}

}  // namespace

Messages OdometryNode::Handle(const Message& message) {
  const auto* chunk = std::get_if<CloudChunk>(&message);
  if (chunk == nullptr) return {};
  const Utime name = chunk->cloud.sweep_utime;
  Odometry::CheckTimes(chunk->cloud);
  const bool ended = sweeps_.Ended(name);
  sweeps_.Add(*chunk);
  if (ended || !sweeps_.Ended(name)) return {};
  const std::optional<Cloud> sweep = sweeps_.Complete(name);
  if (!sweep) return {};
  const OdometryResult before = newest_;
  newest_ = odometry_.Add(*sweep);
  ++taken_;
  if (tell_) tell_(*sweep, newest_);
  if (newest_.restarted) {
    ++restarts_;
    Warn("the map is begun anew at sweep " + std::to_string(name) +
         ": the way since the last pose is not known");
  }
  Messages answers = PosesOf(before);
  answers.emplace_back(Told());
  return answers;
}

Messages OdometryNode::PosesOf(const OdometryResult& before) {
  if (!newest_.converged) {
    ++not_placed_;
    return {};
  }
  if (!newest_.degenerate.empty()) {
    ++degenerate_;
    if (before.degenerate.empty())
      Warn("not told by what stands about: " + Joined(newest_.degenerate));
  }
  Messages poses;
  if (!newest_.way.empty()) {
    for (const PoseAtTime& pose : newest_.way) {
      if (pose.utime <= told_until_) continue;  // its end was the sweep's before
      poses.emplace_back(StampedPose{poses_++, pose.utime, kSource, pose.world_from_lidar});
    }
    told_until_ = newest_.utime;
    return poses;
  }
  told_until_ = newest_.utime;
  if (newest_.standing) {
    // A track of poses knows no way across a longer gap (PoseTrack::kGap).
    constexpr Utime kWithin = PoseTrack::kGap / 2;
    for (Utime utime = newest_.first_utime; utime < newest_.utime; utime += kWithin) {
      poses.emplace_back(StampedPose{poses_++, utime, kSource, newest_.world_from_lidar});
    }
  } else if (!before.converged && newest_.middle_utime < newest_.utime) {
    // A single pose would be that of a rig that stands.
    poses.emplace_back(
        StampedPose{poses_++, newest_.middle_utime, kSource, newest_.world_from_middle});
  }
  poses.emplace_back(StampedPose{poses_++, newest_.utime, kSource, newest_.world_from_lidar});
  return poses;
}

SweepOdometry OdometryNode::Told() const {
  SweepOdometry told;
  told.seq = taken_ - 1;
  told.utime = newest_.utime;
  told.placed = newest_.converged;
  told.begun_anew = newest_.restarted;
  told.map_from_lidar = newest_.world_from_lidar;
  told.velocity = newest_.velocity;
  told.covariance = newest_.covariance;
  told.untold = newest_.degenerate;
  told.residual_m = newest_.residual_m;
  told.text = Text();
  return told;
}

std::string OdometryNode::Text() const {
  if (taken_ == 0) return "waits for sweeps (CLOUD)";
  if (!newest_.converged) return newest_.reason;
  if (!newest_.degenerate.empty()) {
    return "not told by what stands about: " + Joined(newest_.degenerate);
  }
  const std::string off =
      Format("; points lie %.0f mm off the map's planes", 1e3 * newest_.residual_m);
  if (newest_.standing) return "stop " + std::to_string(taken_) + off;
  return Format("%.1f m/s", newest_.velocity.tail<3>().norm()) + off;
}

Status OdometryNode::GetStatus() const {
  Status status;
  status.ready = true;
  status.text = Text();
  status.counters = {{"sweeps", taken_},
                     {"poses", poses_},
                     {"without a place", not_placed_},
                     {"degenerate", degenerate_},
                     {"maps begun anew", restarts_}};
  return status;
}

}  // namespace rgbdt
