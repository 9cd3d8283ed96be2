#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "calib/odometry/internal/odometry_impl.h"
#include "calib/odometry/internal/stop_search.h"

namespace rgbdt {
namespace {

using odometry::Motion;
using odometry::Registration;
using odometry::ShareOf;
using odometry::Stop;
using odometry::SweepMotion;
using odometry::Text;
using odometry::TimedSweep;
using odometry::WayRegistration;

// Of a turned scanner's rig that drives, see RegisterWay. One that half as much scatter puts
// elsewhere is not known.
constexpr double kScatter = 0.1;       // [m]
constexpr double kMostApart = 0.1;     // [m]
constexpr std::size_t kMostOpen = 10;  // parts that wait for the next sweep
constexpr double kLeastNear = 0.85;    // of the share that lies on planes as a rule
constexpr double kBetter = 1.1;        // so much more lies on planes where the rig drove

// Of two ways, over their first `settled` parts [m]; turns by what they move at 1 m.
double MostApart(const WayRegistration& a, const WayRegistration& b, std::size_t settled) {
  double most = 0;
  for (std::size_t k = 0; k < settled; ++k) {
    const Rigid3 apart = a.parts[k].world_from_lidar.Inverse() * b.parts[k].world_from_lidar;
    const double own = std::max(apart.translation.norm(), RotationDistance(apart, {}));
    if (!std::isfinite(own)) return HUGE_VAL;
    most = std::max(most, own);
  }
  return most;
}

}  // namespace

// A turned scanner's sweep covers more at a time and meets the map less often: of wrong places the
// points that find none are not missed, and the first sweep tells nothing of what is usual.
std::string Odometry::Impl::WhyNotTurned(std::size_t selected, const Registration& found,
                                         const Motion& before) const {
  std::string why = WhyNot(selected, found, before, 1);
  if (!why.empty()) return why;
  const double most = std::max(odometry::kLeastBad, 2 * options.range_sigma_m);
  if (usual_near == 0 && found.residual_m > most) {
    return Text("the sweep's points lie %.0f mm off the map (median); expected %.0f mm or less",
                1000 * found.residual_m, 1000 * most);
  }
  if (ShareOf(found.near, selected) < kLeastNear * usual_near) {
    return Text("%.0f%% of the sweep's points lie on the map's planes; %.0f%% is usual",
                100 * ShareOf(found.near, selected), 100 * usual_near);
  }
  return why;
}

// Whether it stood somewhere near the last stop; then the map has it. Where it fits two places
// about as well, it is the better one.
bool Odometry::Impl::Found(const TimedSweep& stop) {
  const Motion before = odometry::AfterStop(motion, lost);
  const Registration best = odometry::FindStop(stop, map, before, lost, options).best;
  const std::size_t selected = stop.selected.size();
  if (!WhyNotTurned(selected, best, before).empty()) {
    Lose(stop, 0);
    return false;
  }
  OdometryResult ignored;
  Place(best, selected, &ignored);
  Grow(stop);
  return true;
}

// A rig that stood for the sweep, or one that drove on meanwhile.
void Odometry::Impl::FollowTurned(const Cloud& cloud, const TimedSweep& sweep,
                                  OdometryResult* result) {
  const Motion before = odometry::AfterStop(motion, lost);
  const Stop stop = odometry::FindStop(sweep, map, before, lost, options);
  const std::size_t selected = sweep.selected.size();
  result->reason = WhyNotTurned(selected, stop.best, before);
  if (result->reason.empty() && stop.other) {
    const Rigid3 apart = stop.best.motion.world_from_lidar.Inverse() * *stop.other;
    result->reason = Text("the sweep fits two places about as well, %.1f m and %.0f degrees apart",
                          apart.translation.norm(), RotationDistance(apart, {}) * 180 / M_PI);
  }
  const double stood = result->reason.empty() ? ShareOf(stop.best.near, selected) : 0;
  if (Drive(cloud, sweep, stood, result)) return;
  Tell(stop.best, result);
  if (result->reason.empty()) {
    Place(stop.best, selected, result);
    middle = sweep.last;
    open.clear();
    Grow(sweep);
  } else {
    result->reason +=
        "; a turned scanner's rig is to stand while it sweeps and to go on by a metre or two, or, "
        "from such a sweep on, to drive slowly, sweep after sweep";
    Lose(sweep, ToSeconds(sweep.middle - middle));
  }
  Report(sweep, result);
}

// Whether all of it lies on the map, as points that find no plane are not missed by least squares;
// the sweep tells all directions; and the first `settled` parts are known.
bool Odometry::Impl::IsWay(const WayRegistration& way, std::size_t settled) const {
  constexpr double kMostSigma = 0.1;          // [m]
  constexpr double kLeastShare = 0.75;        // of what lies near planes as a rule, everywhere
  constexpr double kLeastShareAtFirst = 0.5;  // of all points, where nothing is usual yet
  if (!WhyNotTurned(way.selected, way.whole, way.whole.motion).empty()) return false;
  const double near = ShareOf(way.whole.near, way.selected);
  if (near < kLeastShareAtFirst) return false;
  const double usual = usual_near > 0 ? usual_near : near;
  if (way.worst_near < kLeastShare * usual || way.whole.degenerate.cols() > 0) return false;
  return std::all_of(way.parts.begin(), way.parts.begin() + static_cast<std::ptrdiff_t>(settled),
                     [](const Motion& part) {
                       return part.covariance.diagonal().segment<3>(3).maxCoeff() <=
                              kMostSigma * kMostSigma;
                     });
}

// Whether it drove on from where it was at the end of the sweep before. `stood`: the share of the
// points that lie near a plane where it stands. The last parts hardly know where they are, as what
// tells of it is seen only when the scanner has turned on: they wait for the next sweep.
bool Odometry::Impl::Drive(const Cloud& cloud, const TimedSweep& sweep, double stood,
                           OdometryResult* result) {
  if (kBetter * stood >= 1 || lost > 0 || sweep.first < last ||
      ToSeconds(sweep.first - last) > kMostGap)
    return false;
  std::vector<TimedSweep> parts = open;
  const std::vector<TimedSweep> own = odometry::PartsOf(cloud, options);
  parts.insert(parts.end(), own.begin(), own.end());
  const std::size_t settled = parts.size() - std::min(kMostOpen, own.size() / 3);
  const auto along = [&](double scatter_m) {
    return odometry::RegisterWay(parts, map, odometry::SetOff(motion), middle, scatter_m, options);
  };
  const WayRegistration way = along(kScatter), other = along(kScatter / 2);
  if (!IsWay(way, settled) || !other.whole.converged) return false;
  if (MostApart(way, other, settled) > kMostApart) return false;
  if (ShareOf(way.whole.near, way.selected) < kBetter * stood) return false;
  Tell(way.whole, result);
  result->reason.clear();
  result->selected = way.selected;
  Place(way.whole, way.selected, result);
  for (std::size_t k = 0; k < settled; ++k) {
    const Motion& part = way.parts[k];
    const SweepMotion moved(part.world_from_lidar, part.velocity, parts[k].seconds);
    Forget(part.world_from_lidar.translation);
    map.Add(odometry::InWorld(parts[k], moved), part.world_from_lidar.translation);
  }
  ReportWay(sweep, parts, way, settled, result);
  motion = way.parts[settled - 1];
  motion.covariance = way.so_far[settled - 1];
  middle = parts[settled - 1].middle;
  open.assign(parts.begin() + static_cast<std::ptrdiff_t>(settled), parts.end());
  return true;
}

void Odometry::Impl::ReportWay(const TimedSweep& sweep, const std::vector<TimedSweep>& parts,
                               const WayRegistration& way, std::size_t settled,
                               OdometryResult* result) const {
  const auto at = [&](std::size_t part, Utime utime) {
    return odometry::Predict(way.parts[part], ToSeconds(utime - parts[part].middle), options);
  };
  const auto part_of = [&](Utime utime) {
    std::size_t k = 0;
    while (k + 1 < settled && parts[k + 1].first <= utime) ++k;
    return k;
  };
  const std::size_t middle_part = part_of(sweep.middle);
  result->middle_utime = sweep.middle;
  result->world_from_middle = at(middle_part, sweep.middle).world_from_lidar;
  result->velocity = way.parts[middle_part].velocity;
  for (std::size_t k = 0; k < settled; ++k) {
    result->way.push_back({parts[k].first, at(k, parts[k].first).world_from_lidar});
    const bool gap = k + 1 < settled && parts[k + 1].first > parts[k].last;
    if (gap) result->way.push_back({parts[k].last, at(k, parts[k].last).world_from_lidar});
  }
  result->utime = parts[settled - 1].last;
  const Motion at_end = at(settled - 1, result->utime);
  result->world_from_lidar = at_end.world_from_lidar;
  result->covariance = at_end.covariance.topLeftCorner<6, 6>();
  result->way.push_back({result->utime, at_end.world_from_lidar});
  result->first_utime = result->way.front().utime;
}

}  // namespace rgbdt
