#include "calib/odometry/internal/loop_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "calib/model/linear_algebra.h"
#include "calib/odometry/internal/loop_check.h"

namespace rgbdt::odometry {
namespace {

// Chi-square of six numbers that chance exceeds once in 10^4 times.
constexpr double kMostChiSquare = 27.9;
constexpr std::size_t kLooked = 25;     // earlier places by their means; of these
constexpr std::size_t kAlike = 2;       // are tried, most alike first
constexpr std::size_t kApart = 5;       // keyframes: nearer ones are the same place
constexpr double kAside = 1.5;          // [m] of starts about the place itself
constexpr double kNear = 8;             // [m] by odometry: tried, however it looks
constexpr double kStartPlace = 2;       // [m] a start is off by, 1 sigma
constexpr double kStartTurn = 0.15;     // [rad] likewise
constexpr std::size_t kWitnesses = 2;   // other loops that agree with one
constexpr std::size_t kNeighbours = 8;  // keyframes from it at most
constexpr std::size_t kMostMaps = 32;   // that are kept for the next keyframe

struct Candidate {
  std::size_t old;
  std::vector<Rigid3> starts;  // old_from_new
};

std::vector<Rigid3> StartsAbout(double yaw) {
  const Rigid3 turned = RotationAbout(Eigen::Vector3d::UnitZ(), yaw);
  std::vector<Rigid3> starts{turned};
  for (const double aside : {-kAside, kAside}) {
    starts.push_back({turned.rotation, {aside, 0, 0}});
    starts.push_back({turned.rotation, {0, aside, 0}});
  }
  return starts;
}

double ChiSquareOfStart(const PoseEdge& by_odometry, const Rigid3& start) {
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(kStartTurn), Eigen::Vector3d::Constant(kStartPlace);
  PoseEdge edge = by_odometry;
  edge.from_from_to = start;
  edge.covariance = sigma.cwiseAbs2().asDiagonal();
  return ChiSquare(by_odometry, edge);
}

class Search {
 public:
  explicit Search(const KeyframeStore& store) : store_(store), frames_(store.frames()) {}

  FoundLoops Run() {
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      for (const Candidate& candidate : CandidatesFor(i)) {
        if (Try(candidate, i)) break;
      }
    }
    KeepBorneOut();
    return std::move(found_);
  }

 private:
  bool IsLongAgo(std::size_t old, std::size_t index) const {
    return frames_[index].way_m - frames_[old].way_m >= store_.options().least_way_m;
  }
  std::vector<Candidate> CandidatesFor(std::size_t index) const;
  std::optional<std::size_t> Nearest(std::size_t index) const;
  std::vector<std::pair<Unlikeness, std::size_t>> MostAlike(std::size_t index) const;
  const PlaneMap& MapAbout(std::size_t old);
  bool Try(const Candidate& candidate, std::size_t index);
  bool Agree(const PoseEdge& a, const PoseEdge& b) const;
  void KeepBorneOut();

  const KeyframeStore& store_;
  const std::vector<Keyframe>& frames_;
  std::map<std::size_t, PlaneMap> maps_;
  FoundLoops found_;
};

std::optional<std::size_t> Search::Nearest(std::size_t index) const {
  std::optional<std::size_t> nearest;
  double least = kNear;
  for (std::size_t i = 0; i < index && IsLongAgo(i, index); ++i) {
    const double distance =
        (frames_[i].world_from_middle.translation - frames_[index].world_from_middle.translation)
            .norm();
    if (distance >= least) continue;
    least = distance;
    nearest = i;
  }
  return nearest;
}

// Earlier places that look alike, with by how much the new one looks to the left of them.
std::vector<std::pair<Unlikeness, std::size_t>> Search::MostAlike(std::size_t index) const {
  const Place& place = frames_[index].place;
  std::vector<std::pair<float, std::size_t>> by_mean;
  for (std::size_t i = 0; i < index && IsLongAgo(i, index); ++i) {
    by_mean.emplace_back((frames_[i].place.mean - place.mean).cwiseAbs().sum(), i);
  }
  std::sort(by_mean.begin(), by_mean.end());
  if (by_mean.size() > kLooked) by_mean.resize(kLooked);
  std::vector<std::pair<Unlikeness, std::size_t>> alike;
  for (const auto& looked : by_mean) {
    const Unlikeness unlike = Compare(frames_[looked.second].place, place);
    if (unlike.value <= store_.options().most_unlike) alike.emplace_back(unlike, looked.second);
  }
  std::sort(alike.begin(), alike.end(), [](const auto& a, const auto& b) {
    return std::pair(a.first.value, a.second) < std::pair(b.first.value, b.second);
  });
  return alike;
}

std::vector<Candidate> Search::CandidatesFor(std::size_t index) const {
  std::vector<Candidate> candidates;
  const std::optional<std::size_t> nearest = Nearest(index);
  if (nearest) {
    candidates.push_back(
        {*nearest,
         {frames_[*nearest].world_from_middle.Inverse() * frames_[index].world_from_middle}});
  }
  std::vector<std::size_t> taken;
  for (const auto& [unlike, old] : MostAlike(index)) {
    bool same = false;
    for (const std::size_t t : taken) same = same || std::max(t, old) - std::min(t, old) < kApart;
    if (same) continue;
    taken.push_back(old);
    candidates.push_back({old, StartsAbout(unlike.yaw_rad)});
    if (taken.size() == kAlike) break;
  }
  return candidates;
}

const PlaneMap& Search::MapAbout(std::size_t old) {
  const auto map = maps_.find(old);
  if (map != maps_.end()) return map->second;
  if (maps_.size() >= kMostMaps) maps_.erase(maps_.begin());
  return maps_.emplace(old, store_.MapAbout(old)).first->second;
}

bool Search::Try(const Candidate& candidate, std::size_t index) {
  ++found_.tried;
  const PoseEdge by_odometry = store_.ByOdometry(candidate.old, index);
  if (ChiSquareOfStart(by_odometry, candidate.starts.front()) > kMostChiSquare) {
    ++found_.against_odometry;
    return false;
  }
  const LoopCheck check =
      CheckLoop(MapAbout(candidate.old), frames_[index], candidate.starts, store_.odometry());
  if (!check.why_not.empty()) {
    ++found_.do_not_fit;
    return false;
  }
  const PoseEdge loop{candidate.old, index, check.old_from_new, check.covariance};
  if (ChiSquare(by_odometry, loop) > kMostChiSquare) {
    ++found_.against_odometry;
    return false;
  }
  found_.loops.push_back(loop);
  return true;
}

// Both ways from a's old place to b's new one are the same (pairwise consistency).
bool Search::Agree(const PoseEdge& a, const PoseEdge& b) const {
  const PoseEdge by_a = Chained(a, store_.Between(a.to, b.to));
  const PoseEdge by_b = Chained(store_.Between(a.from, b.from), b);
  return ChiSquare(by_a, by_b) <= kMostChiSquare;
}

void Search::KeepBorneOut() {
  std::vector<PoseEdge> kept;
  for (const PoseEdge& loop : found_.loops) {
    std::size_t witnesses = 0;
    for (const PoseEdge& other : found_.loops) {
      const std::size_t apart = std::max(loop.to, other.to) - std::min(loop.to, other.to);
      if (apart == 0 || apart > kNeighbours) continue;
      if (Agree(loop, other)) ++witnesses;
    }
    if (witnesses >= kWitnesses) kept.push_back(loop);
  }
  found_.alone = found_.loops.size() - kept.size();
  found_.loops = std::move(kept);
}

}  // namespace

FoundLoops FindLoops(const KeyframeStore& store) { return Search(store).Run(); }

}  // namespace rgbdt::odometry
