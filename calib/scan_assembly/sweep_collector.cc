#include "calib/scan_assembly/sweep_collector.h"

#include <algorithm>
#include <string>
#include <utility>

#include "calib/model/errors.h"
#include "calib/model/said_again.h"
#include "calib/scan_assembly/sweep_chunks.h"

namespace rgbdt {
namespace {

constexpr std::size_t kChunkPoints = 8;  // an empty chunk takes as much memory

int LinesToldBy(const CloudChunk& chunk) {
  const Cloud& cloud = chunk.cloud;
  return std::max(chunk.sweep_lines, cloud.size() == 0 ? 0 : cloud.first_line + cloud.lines);
}

}  // namespace

void SweepCollector::Check(const Sweep& sweep, const CloudChunk& chunk) {
  const std::string name = "sweep " + std::to_string(chunk.cloud.sweep_utime);
  if (sweep.chunks.size() >= kMaxChunks) {
    throw InputError(name + " has more than " + std::to_string(kMaxChunks) + " chunks");
  }
  const Cloud* first = sweep.first ? &sweep.chunks[*sweep.first].cloud : nullptr;
  const Cloud& like = first == nullptr || chunk.cloud.size() != 0 ? chunk.cloud : *first;
  // An unorganised sweep is not filled up where lines are lost.
  const int lines = like.organised ? std::max(sweep.lines, LinesToldBy(chunk))
                                   : chunk.cloud.first_line + chunk.cloud.lines;
  const int beams = like.organised ? like.beams : chunk.cloud.beams;
  const std::size_t reach = static_cast<std::size_t>(lines) * static_cast<std::size_t>(beams);
  if (std::max(reach, sweep.points + chunk.cloud.size()) > kMaxPoints) {
    throw InputError(name + " has more than " + std::to_string(kMaxPoints) + " points");
  }
  if (first == nullptr || chunk.cloud.size() == 0) return;
  RequireJoinable(*first, chunk.cloud);
}

void SweepCollector::Add(CloudChunk chunk) {
  const auto found = sweeps_.find(chunk.cloud.sweep_utime);
  const bool again = chunk.seq == kSaidAgain;
  if (found != sweeps_.end() && found->second.said_again != again) {
    if (!again) return;
    Check(Sweep(), chunk);
    found->second = Sweep();
  }
  const std::tuple place(chunk.cloud.first_line, chunk.cloud.lines, chunk.cloud.beams,
                         chunk.sweep_end);
  if (found != sweeps_.end() && found->second.came.count(place) != 0) return;
  static const Sweep kNone;
  Check(found == sweeps_.end() ? kNone : found->second, chunk);
  Sweep& sweep = sweeps_[chunk.cloud.sweep_utime];
  sweep.said_again = again;
  sweep.came.insert(place);
  if (!sweep.first && chunk.cloud.size() != 0) sweep.first = sweep.chunks.size();
  sweep.points += std::max(chunk.cloud.size(), kChunkPoints);
  sweep.lines = std::max(sweep.lines, LinesToldBy(chunk));
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

std::vector<CloudChunk> SweepCollector::ChunksOf(Utime sweep_utime) const {
  const auto found = sweeps_.find(sweep_utime);
  return found == sweeps_.end() ? std::vector<CloudChunk>() : found->second.chunks;
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

std::vector<Utime> SweepCollector::Newest(std::size_t most) const {
  std::vector<Utime> newest;
  for (auto sweep = sweeps_.rbegin(); sweep != sweeps_.rend() && newest.size() < most; ++sweep) {
    newest.insert(newest.begin(), sweep->first);
  }
  return newest;
}

std::optional<Cloud> SweepCollector::Complete(Utime sweep_utime) const {
  if (!Ended(sweep_utime)) return std::nullopt;
  Cloud cloud = JoinChunks(sweeps_.at(sweep_utime).chunks);
  cloud.sweep_utime = sweep_utime;
  return cloud;
}

std::string SweepCollector::WhyTorn(Utime sweep_utime) const {
  if (!Ended(sweep_utime)) return "";
  const Sweep& sweep = sweeps_.at(sweep_utime);
  const int missing = MissingLines(sweep.chunks);
  if (missing <= kMaxMissing * sweep.lines) return "";
  return "sweep " + std::to_string(sweep_utime) + " is not whole: " + std::to_string(missing) +
         " of its " + std::to_string(sweep.lines) +
         " lines never came (rgbdt-assembler or this process was started anew, a clock was set, or "
         "messages were lost: gaps in STATUS)";
}

}  // namespace rgbdt
