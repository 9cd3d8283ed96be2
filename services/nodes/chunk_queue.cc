#include "services/nodes/chunk_queue.h"

#include <algorithm>
#include <utility>

#include "calib/model/pose_track.h"
#include "services/nodes/odometry_node.h"

namespace rgbdt {

void ChunkQueue::OnPose(const StampedPose& pose) {
  newest_pose_ = pose.source == OdometryNode::kSource ? std::optional(pose.utime) : std::nullopt;
  heard_ = true;
}

bool ChunkQueue::Keep(const CloudChunk& chunk) {
  const Cloud& cloud = chunk.cloud;
  Utime last = cloud.sweep_utime;
  for (const Utime utime : cloud.utime) last = std::max(last, utime);
  longest_sweep_ = std::max(longest_sweep_, std::min(last - cloud.sweep_utime, kLongestSweep));
  // A clock that was set back: no pose comes for what waits.
  if (!chunks_.empty() && last < chunks_.back().last - kLongestSweep) newest_pose_.reset();
  if (chunks_.empty() && IsDue(last, last)) return false;
  points_ += cloud.size();
  chunks_.push_back({chunk, last});
  heard_ = true;
  return true;
}

bool ChunkQueue::IsDue(Utime last, Utime newest) const {
  if (!newest_pose_ || given_up_ || points_ > kMostPoints) return true;
  return last - *newest_pose_ <= PoseTrack::kAhead || newest - *newest_pose_ > MostWait();
}

std::optional<CloudChunk> ChunkQueue::Next() {
  if (chunks_.empty() || !IsDue(chunks_.front().last, chunks_.back().last)) return std::nullopt;
  CloudChunk chunk = std::move(chunks_.front().chunk);
  chunks_.pop_front();
  points_ -= chunk.cloud.size();
  return chunk;
}

void ChunkQueue::Advance(Utime now) {
  if (std::exchange(heard_, false) || chunks_.empty()) heard_at_ = now;
  given_up_ = now - heard_at_ > MostWait();
}

void ChunkQueue::Clear() { *this = ChunkQueue(); }

}  // namespace rgbdt
