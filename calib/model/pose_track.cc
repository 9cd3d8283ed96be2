#include "calib/model/pose_track.h"

#include <algorithm>

namespace rgbdt {
namespace {

// From a to b and on, `share` of the way.
Rigid3 Between(const StampedPose& a, const StampedPose& b, Utime utime) {
  const double share =
      static_cast<double>(utime - a.utime) / static_cast<double>(b.utime - a.utime);
  return Exp(share * Log(b.map_from_lidar * a.map_from_lidar.Inverse())) * a.map_from_lidar;
}

bool IsJump(const StampedPose& a, const StampedPose& b) {
  const double seconds = ToSeconds(b.utime - a.utime);
  // Besides speed, what a filter corrects from one pose to the next.
  constexpr double kCorrectedM = 0.3;
  constexpr double kCorrectedRad = 0.2;
  return (b.map_from_lidar.translation - a.map_from_lidar.translation).norm() >
             kCorrectedM + PoseTrack::kMostSpeed * seconds ||
         RotationDistance(a.map_from_lidar, b.map_from_lidar) >
             kCorrectedRad + PoseTrack::kMostTurn * seconds;
}

}  // namespace

PoseTrack::Added PoseTrack::Add(const StampedPose& pose) {
  constexpr Utime kClockReset = 10 * kMicrosecondsPerSecond;
  if (!poses_.empty()) {
    const StampedPose& newest = poses_.back();
    const bool set_back = pose.utime < newest.utime - kClockReset;
    if (!set_back && pose.utime <= newest.utime) return Added::kOld;
    if (set_back || IsJump(newest, pose)) {
      poses_.assign(1, pose);
      return Added::kJump;
    }
  }
  poses_.push_back(pose);
  while (poses_.front().utime < pose.utime - kKept) poses_.pop_front();
  return Added::kYes;
}

std::optional<Rigid3> PoseTrack::At(Utime utime) const {
  if (poses_.empty()) return std::nullopt;
  if (poses_.size() == 1) return poses_.front().map_from_lidar;
  if (utime < poses_.front().utime) return std::nullopt;
  const StampedPose& newest = poses_.back();
  if (utime > newest.utime + kAhead) return std::nullopt;
  const auto not_before = std::find_if(poses_.rbegin(), poses_.rend(), [&](const StampedPose& p) {
                            return p.utime < utime;
                          }).base();
  if (not_before != poses_.end() && not_before->utime == utime) return not_before->map_from_lidar;
  const auto second = not_before == poses_.end() ? not_before - 1 : not_before;
  const auto first = second - 1;
  if (second->utime - first->utime > kGap) return std::nullopt;
  return Between(*first, *second, utime);
}

}  // namespace rgbdt
