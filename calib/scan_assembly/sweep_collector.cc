#include "calib/scan_assembly/sweep_collector.h"

#include <algorithm>
#include <string>
#include <utility>

#include "calib/model/errors.h"
#include "calib/scan_assembly/sweep_chunks.h"

namespace rgbdt {

void SweepCollector::Check(const Sweep& sweep, const CloudChunk& chunk) {
  const std::string name = "sweep " + std::to_string(chunk.cloud.sweep_utime);
  if (sweep.chunks.size() >= kMaxChunks) {
    throw InputError(name + " has more than " + std::to_string(kMaxChunks) + " chunks");
  }
  const std::size_t reach = static_cast<std::size_t>(chunk.cloud.first_line + chunk.cloud.lines) *
                            static_cast<std::size_t>(chunk.cloud.beams);
  if (std::max(reach, sweep.points + chunk.cloud.size()) > kMaxPoints) {
    throw InputError(name + " has more than " + std::to_string(kMaxPoints) + " points");
  }
  const auto first = std::find_if(sweep.chunks.begin(), sweep.chunks.end(),
                                  [](const CloudChunk& c) { return c.cloud.size() != 0; });
  if (first == sweep.chunks.end() || chunk.cloud.size() == 0) return;
  RequireJoinable(first->cloud, chunk.cloud);
}

void SweepCollector::Add(CloudChunk chunk) {
  const auto found = sweeps_.find(chunk.cloud.sweep_utime);
  static const Sweep kNone;
  Check(found == sweeps_.end() ? kNone : found->second, chunk);
  Sweep& sweep = sweeps_[chunk.cloud.sweep_utime];
  sweep.points += chunk.cloud.size();
  sweep.ended |= chunk.sweep_end;
  sweep.chunks.push_back(std::move(chunk));
  ForgetOldest();
}

void SweepCollector::ForgetOldest() {
  std::size_t points = 0;
  for (const auto& [utime, sweep] : sweeps_) points += sweep.points;
  while (sweeps_.size() > kMaxSweeps || (sweeps_.size() > kMinSweeps && points > kKeptPoints)) {
    points -= sweeps_.begin()->second.points;
    sweeps_.erase(sweeps_.begin());
  }
}

bool SweepCollector::Ended(Utime sweep_utime) const {
  const auto found = sweeps_.find(sweep_utime);
  return found != sweeps_.end() && found->second.ended;
}

Utime SweepCollector::NewestEnded() const {
  for (auto sweep = sweeps_.rbegin(); sweep != sweeps_.rend(); ++sweep) {
    if (sweep->second.ended) return sweep->first;
  }
  return 0;
}

std::optional<Cloud> SweepCollector::Complete(Utime sweep_utime) const {
  if (!Ended(sweep_utime)) return std::nullopt;
  Cloud cloud = JoinChunks(sweeps_.at(sweep_utime).chunks);
  cloud.sweep_utime = sweep_utime;
  return cloud;
}

}  // namespace rgbdt
