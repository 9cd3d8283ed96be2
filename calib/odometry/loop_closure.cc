#include "calib/odometry/loop_closure.h"

#include <algorithm>
#include <utility>

#include "calib/model/check.h"
#include "calib/odometry/internal/keyframes.h"
#include "calib/odometry/internal/loop_search.h"
#include "calib/odometry/internal/pose_graph.h"

namespace rgbdt {
namespace {

using odometry::FoundLoops;
using odometry::Keyframe;
using odometry::KeyframeStore;
using odometry::PoseEdge;
using odometry::SolvedGraph;

ClosedWay AsItWas(const std::vector<Keyframe>& frames, const FoundLoops& found) {
  ClosedWay way;
  way.tried = found.tried;
  way.do_not_fit = found.do_not_fit;
  way.against_odometry = found.against_odometry;
  way.alone = found.alone;
  for (const Keyframe& frame : frames) {
    way.utimes.push_back(frame.sweep.middle);
    way.before.push_back(frame.world_from_middle);
  }
  way.after = way.before;
  return way;
}

ClosedLoop LoopOf(const PoseEdge& edge, const LoopColours& colours, const ClosedWay& way) {
  ClosedLoop loop{way.utimes[edge.from], way.utimes[edge.to], edge.from_from_to, {}};
  loop.colours = colours.Compare({loop.old_utime, loop.new_utime, way.before[edge.from],
                                  way.before[edge.to], loop.old_from_new});
  loop.sigma_factor = LoopColours::SigmaFactor(loop.colours);
  return loop;
}

void Take(const SolvedGraph& graph, const std::vector<ClosedLoop>& loops, ClosedWay* way) {
  way->contradict = loops.size() - graph.kept.size();
  way->after = graph.poses;
  for (const std::size_t i : graph.kept) way->loops.push_back(loops[i]);
  for (std::size_t i = 0; i < way->after.size(); ++i) {
    way->end_moved_m = (way->after[i].translation - way->before[i].translation).norm();
    way->most_moved_m = std::max(way->most_moved_m, way->end_moved_m);
  }
}

}  // namespace

void LoopClosureOptions::Check() const {
  constexpr OptionCheck check("loop closure");
  check.Between(keyframe_m, 0.1, 20, "keyframe_m");
  check.Between(keyframe_rad, 0.05, 3, "keyframe_rad");
  check.Require(max_keyframes >= 10 && max_keyframes <= 1000000, "max_keyframes",
                static_cast<double>(max_keyframes), "10 to 1e6");
  check.Require(map_points >= 1000 && map_points <= 1000000, "map_points",
                static_cast<double>(map_points), "1000 to 1e6");
  check.Between(about_m, 2, 100, "about_m");
  check.Require(least_way_m >= 2 * about_m && least_way_m <= 10000, "least_way_m", least_way_m,
                "twice about_m or more, up to 10000");
  check.Between(most_unlike, 0, 1, "most_unlike");
  check.NotNegative(drift_share, "drift_share");
  check.NotNegative(drift_radpm, "drift_radpm");
}

struct Keyframes::Impl {
  KeyframeStore store;
};

Keyframes::Keyframes(const LoopClosureOptions& options, const OdometryOptions& odometry) {
  options.Check();
  odometry.Check();
  impl_ = std::make_unique<Impl>(Impl{KeyframeStore(options, odometry)});
}
Keyframes::~Keyframes() = default;
Keyframes::Keyframes(Keyframes&&) noexcept = default;
Keyframes& Keyframes::operator=(Keyframes&&) noexcept = default;

void Keyframes::Add(const Cloud& sweep, const OdometryResult& found) {
  impl_->store.Add(sweep, found);
}

std::size_t Keyframes::size() const { return impl_->store.frames().size(); }

ClosedWay CloseLoops(const Keyframes& keyframes, const LoopColours& colours) {
  const KeyframeStore& store = keyframes.impl_->store;
  FoundLoops found = odometry::FindLoops(store);
  ClosedWay way = AsItWas(store.frames(), found);
  if (found.loops.empty()) return way;
  std::vector<ClosedLoop> loops;
  for (PoseEdge& edge : found.loops) {
    loops.push_back(LoopOf(edge, colours, way));
    edge.covariance *= loops.back().sigma_factor * loops.back().sigma_factor;
  }
  const auto graph = odometry::SolveGraph(way.before, store.chain(), found.loops);
  way.solved = graph.has_value();
  if (graph && !graph->kept.empty()) {
    Take(*graph, loops, &way);
  } else {
    way.contradict = found.loops.size();
  }
  return way;
}

Rigid3 ClosedWay::Corrected(Utime utime, const Rigid3& world_from_lidar) const {
  if (loops.empty()) return world_from_lidar;
  const auto next = std::upper_bound(utimes.begin(), utimes.end(), utime);
  const auto moved_as = [&](std::size_t i) {
    return after[i] * (before[i].Inverse() * world_from_lidar);
  };
  if (next == utimes.begin()) return moved_as(0);
  const auto b = static_cast<std::size_t>(next - utimes.begin());
  Rigid3 from = moved_as(b - 1);
  if (next == utimes.end()) return from;
  const double share = ToSeconds(utime - utimes[b - 1]) / ToSeconds(utimes[b] - utimes[b - 1]);
  return from * Exp(Vector6d(share * Log(from.Inverse() * moved_as(b))));
}

}  // namespace rgbdt
