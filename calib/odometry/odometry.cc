#include "calib/odometry/odometry.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "calib/model/check.h"
#include "calib/model/errors.h"
#include "calib/odometry/internal/degeneracy.h"
#include "calib/odometry/internal/odometry_impl.h"
#include "calib/odometry/internal/stop_search.h"

namespace rgbdt {
namespace {

using odometry::kLeastBad;
using odometry::Motion;
using odometry::Registration;
using odometry::ShareOf;
using odometry::SweepMotion;
using odometry::Text;
using odometry::TimedSweep;
using odometry::Untold;

constexpr std::size_t kFewestPoints = 300;
constexpr Utime kClockReset = 10 * kMicrosecondsPerSecond;
constexpr int kStraightening = 8;    // rounds
constexpr double kStraight = 1e-3;   // [m/s], and rad/s: the first sweep is straight
constexpr double kForgetEvery = 10;  // [m]
constexpr double kLeastKept = 2;     // [m], however full the map is
constexpr double kLeastFit = 0.7;    // of the matched points within 0.1 m of their plane
constexpr std::size_t kFewestMatched = 100;
constexpr double kMostAcceleration = 40;  // [m/s^2] and [rad/s^2]: faster is a jump

// A sweep that lies so much worse on the map than usual may have found the wrong place: it is tried
// from turns that change by so much about each axis, too.
constexpr double kWorse = 1.3;
constexpr double kMuchWorse = 2;      // and so much worse is another place
constexpr double kLeastShare = 0.75;  // of the share that finds a plane as a rule
constexpr double kOtherTurn = 0.2;    // [rad/s]
constexpr double kUsualOver = 10;     // sweeps

// Before anything is seen: 1 sigma.
constexpr double kFirstSpeed = 15;  // [m/s]
constexpr double kFirstTurn = 1;    // [rad/s]

Motion Unknown(const Rigid3& world_from_lidar) {
  Motion motion;
  motion.world_from_lidar = world_from_lidar;
  motion.covariance.setZero();
  odometry::Vector12d sigma;
  sigma << Vector6d::Constant(1e-4), Eigen::Vector3d::Constant(kFirstTurn),
      Eigen::Vector3d::Constant(kFirstSpeed);
  motion.covariance.diagonal() = sigma.cwiseAbs2();
  return motion;
}

const char* KindOf(bool turned) { return turned ? "turned scanner" : "spinning LIDAR"; }

}  // namespace

namespace odometry {

double ShareOf(std::size_t matched, std::size_t selected) {
  return static_cast<double>(matched) / static_cast<double>(std::max<std::size_t>(1, selected));
}

std::string Text(const char* format, double a, double b) {
  char text[200];
  std::snprintf(text, sizeof text, format, a, b);
  return text;
}

}  // namespace odometry

void OdometryOptions::Check() const {
  constexpr OptionCheck check("odometry");
  check.Require(min_range_m >= 0.05, "min_range_m", min_range_m, "0.05 or more");
  check.Require(max_range_m > min_range_m && max_range_m <= 1000, "max_range_m", max_range_m,
                "more than min_range_m, up to 1000");
  check.Require(selected >= 500 && selected <= 1000000, "selected", static_cast<double>(selected),
                "500 to 1e6");
  check.NotNegative(range_sigma_m, "range_sigma_m");
  check.Positive(acceleration_mps2, "acceleration_mps2");
  check.Positive(turn_radps2, "turn_radps2");
  check.Positive(degenerate_m, "degenerate_m");
  check.Between(keep_m, 5, 1000, "keep_m");
  check.Require(max_voxels >= 10000 && max_voxels <= 100000000, "max_voxels",
                static_cast<double>(max_voxels), "1e4 to 1e8");
}

// The map begins with this sweep, as far as its own motion is known: the second tells it.
void Odometry::Impl::Begin(const TimedSweep& sweep) {
  map.Clear();
  middle = sweep.turned ? sweep.last : sweep.middle;
  turned = sweep.turned;
  motion = Unknown(motion.world_from_lidar);
  forgotten_at = motion.world_from_lidar.translation;
  lost = refused = 0;
  usual_residual_m = usual_share = usual_near = 0;
  begun = anew = true;
  first.reset();
  open.clear();
  if (!turned) {
    first = sweep;
    return;
  }
  Grow(sweep);
}

// The first sweep is straightened by the way to the second, which is found on the first: round by
// round both agree.
Registration Odometry::Impl::Second(const TimedSweep& sweep) {
  const double seconds = ToSeconds(sweep.middle - middle);
  const Rigid3 start = motion.world_from_lidar;
  Motion before = odometry::Predict(motion, seconds, options);
  const Motion weak = before;
  Registration found;
  Vector6d velocity = Vector6d::Zero();
  for (int round = 0; round < kStraightening; ++round) {
    map.Clear();
    map.Add(odometry::InWorld(*first, SweepMotion(start, velocity, first->seconds)),
            start.translation);
    before.covariance = weak.covariance;
    found = odometry::Register(sweep, map, before, before, Untold::kAtTheEnd, options);
    const Vector6d way = Log(start.Inverse() * found.motion.world_from_lidar) / seconds;
    if (!way.allFinite()) break;
    const double change = (way - velocity).norm();
    velocity = way;
    before.world_from_lidar = found.motion.world_from_lidar;
    before.velocity = way;
    if (change < kStraight) break;
  }
  return found;
}

// On the map. Where a turn sets in, points find planes that are not theirs, and those that find
// none are not missed: the place at which most points lie near a plane is the right one.
Registration Odometry::Impl::Next(const TimedSweep& sweep, const Motion& before,
                                  double seconds) const {
  Registration best =
      odometry::Register(sweep, map, before, before, Untold::kFromTheBeginning, options);
  bool fits = WhyNot(sweep.selected.size(), best, before, seconds).empty();
  if (fits && best.residual_m <= kWorse * usual_residual_m) return best;
  if (usual_residual_m == 0) return best;
  for (int start = 0; start < 7; ++start) {
    Vector6d turn = Vector6d::Zero();
    if (start > 0) turn[(start - 1) / 2] = start % 2 == 1 ? kOtherTurn : -kOtherTurn;
    Motion other = before;
    other.velocity += turn;
    other.world_from_lidar = before.world_from_lidar * Exp(Vector6d(seconds * turn));
    Registration found = odometry::Register(sweep, map, before, other, Untold::kAtTheEnd, options);
    if (!WhyNot(sweep.selected.size(), found, before, seconds).empty()) continue;
    // Of seven places one may fit somehow that is none.
    if (!fits && found.residual_m > kWorse * usual_residual_m) continue;
    if (fits && found.near <= best.near) continue;
    fits = true;
    best = std::move(found);
  }
  return best;
}

std::string Odometry::Impl::WhyNot(std::size_t selected, const Registration& found,
                                   const Motion& before, double seconds) const {
  if (found.matched < kFewestMatched) {
    return Text("%.0f points of the sweep lie on planes seen before; expected %.0f or more",
                static_cast<double>(found.matched), kFewestMatched);
  }
  if (found.fit < kLeastFit) {
    return Text(
        "%.0f%% of the sweep's points that lie near a plane fit it; expected %.0f%% or more",
        100 * found.fit, 100 * kLeastFit);
  }
  const double worse = usual_residual_m > 0 ? found.residual_m / usual_residual_m : 0;
  if (worse > kMuchWorse && found.residual_m > kLeastBad) {
    return Text("the sweep's points lie %.0f mm off the map (median) where %.0f mm is usual",
                1000 * found.residual_m, 1000 * usual_residual_m);
  }
  const double share = ShareOf(found.matched, selected);
  if (worse > kWorse && share < kLeastShare * usual_share) {
    return Text(
        "%.0f%% of the sweep's points lie on planes seen before, and badly; %.0f%% is usual",
        100 * share, 100 * usual_share);
  }
  const Vector6d change = (found.motion.velocity - before.velocity) / seconds;
  const double most = change.cwiseAbs().maxCoeff();
  if (!(most < kMostAcceleration)) {
    return Text(
        "the sweep fits the map only after a jump (%.0f m/s^2 or rad/s^2; expected up to "
        "%.0f)",
        most, kMostAcceleration);
  }
  if (!found.converged) return "the sweep's place on the map did not settle";
  return "";
}

void Odometry::Impl::Grow(const TimedSweep& sweep) {
  const SweepMotion moved(motion.world_from_lidar, motion.velocity, sweep.seconds);
  Forget(motion.world_from_lidar.translation);
  map.Add(odometry::InWorld(sweep, moved), motion.world_from_lidar.translation);
}

// What is far from this place, and what there is no room for.
void Odometry::Impl::Forget(const Eigen::Vector3d& place) {
  if ((place - forgotten_at).norm() > kForgetEvery) {
    map.Forget(place, options.keep_m);
    forgotten_at = place;
  }
  // A full map keeps what is near: one that grows no more would lose the way.
  for (double keep = options.keep_m; map.size() >= options.max_voxels && keep > kLeastKept;) {
    keep = std::max(kLeastKept, keep / 2);
    map.Forget(place, keep);
  }
}

void Odometry::Impl::Tell(const Registration& found, OdometryResult* result) {
  result->matched = found.matched;
  result->residual_m = found.residual_m;
  result->iterations = found.iterations;
}

void Odometry::Impl::Report(const TimedSweep& sweep, OdometryResult* result) const {
  result->first_utime = sweep.first;
  result->middle_utime = sweep.middle;
  result->utime = sweep.last;
  result->standing = sweep.turned;
  result->world_from_middle = motion.world_from_lidar;
  result->velocity = motion.velocity;
  const double onward = sweep.turned ? 0 : ToSeconds(sweep.last - sweep.middle);
  const Motion at_end = odometry::Predict(motion, onward, options);
  result->world_from_lidar = at_end.world_from_lidar;
  result->covariance = at_end.covariance.topLeftCorner<6, 6>();
}

// The way since the sweep before [s]; 0: the map begins with this one.
double Odometry::Impl::Since(const Cloud& cloud, const TimedSweep& sweep) {
  if (!begun || cloud.sweep_utime < sweep_utime - kClockReset) return 0;
  const double seconds = ToSeconds(sweep.middle - middle);
  const bool back = !turned && seconds <= 0;  // a turned scanner's middle is its sweep's end
  if (cloud.sweep_utime <= sweep_utime || back) {
    throw InputError("sweep " + std::to_string(cloud.sweep_utime) +
                     " is not newer than the one before, " + std::to_string(sweep_utime));
  }
  if (sweep.turned != turned) {
    // A part of a turned scanner's first sweep looks like a spinning LIDAR's: begun anew then.
    if (sweep.turned && (first || ToSeconds(sweep.first - middle) > kMostGap)) return 0;
    if (++refused > kMostLost) return 0;
    throw InputError("sweep " + std::to_string(cloud.sweep_utime) + " is a " +
                     KindOf(sweep.turned) + "'s by how long it lasts, the ones before are a " +
                     KindOf(turned) + "'s; expected those of one LIDAR");
  }
  refused = 0;
  if (turned) return std::max(seconds, ToSeconds(1));
  return seconds <= kMostGap ? seconds : 0;
}

// A sweep that tells nothing: on as before.
void Odometry::Impl::Lose(const TimedSweep& sweep, double seconds) {
  motion = turned ? odometry::AfterStop(motion, lost) : odometry::Predict(motion, seconds, options);
  middle = sweep.middle;
  open.clear();
  if (++lost >= kMostLost) begun = false;
}

OdometryResult Odometry::Impl::Add(const Cloud& cloud) {
  const TimedSweep sweep = odometry::TimeSweep(cloud, options);
  const double seconds = Since(cloud, sweep);
  sweep_utime = cloud.sweep_utime;
  OdometryResult result;
  result.points = sweep.points.size();
  result.selected = sweep.selected.size();
  if (sweep.points.size() < kFewestPoints) {
    result.reason = Text("the sweep has %.0f points of use; expected %.0f or more",
                         static_cast<double>(sweep.points.size()), kFewestPoints);
    if (seconds > 0 && !first) Lose(sweep, seconds);
    if (seconds == 0) begun = false;  // also where the clock was set back
    Report(sweep, &result);
  } else if (seconds == 0) {
    result.restarted = anew;
    result.converged = sweep.turned;  // its place is the map's
    if (!sweep.turned) {
      result.reason = "the map begins with this sweep; the next one tells how it moved";
    }
    Begin(sweep);
    Report(sweep, &result);
  } else if (turned) {
    FollowTurned(cloud, sweep, &result);
  } else {
    Follow(sweep, seconds, &result);
  }
  last = sweep.last;
  return result;
}

// It was found where `found` says.
void Odometry::Impl::Place(const Registration& found, std::size_t selected,
                           OdometryResult* result) {
  lost = 0;
  const double weight = usual_residual_m > 0 ? 1 / kUsualOver : 1;
  usual_residual_m += weight * (found.residual_m - usual_residual_m);
  usual_share += weight * (ShareOf(found.matched, selected) - usual_share);
  usual_near += weight * (ShareOf(found.near, selected) - usual_near);
  first.reset();
  motion = found.motion;
  result->converged = true;
  result->degenerate = odometry::DegenerateWords(found.degenerate);
}

void Odometry::Impl::Follow(const TimedSweep& sweep, double seconds, OdometryResult* result) {
  const Motion before = odometry::Predict(motion, seconds, options);
  const Registration found = first ? Second(sweep) : Next(sweep, before, seconds);
  Tell(found, result);
  result->reason = WhyNot(sweep.selected.size(), found, first ? found.motion : before, seconds);
  if (result->reason.empty()) {
    Place(found, sweep.selected.size(), result);
    middle = sweep.middle;
    Grow(sweep);
  } else if (first) {  // neither is better than the other: the newer one leads on
    Begin(sweep);
  } else {
    Lose(sweep, seconds);
  }
  Report(sweep, result);
}

Odometry::Odometry(const OdometryOptions& options) : impl_(std::make_unique<Impl>(options)) {
  options.Check();
}
Odometry::~Odometry() = default;
Odometry::Odometry(Odometry&&) noexcept = default;
Odometry& Odometry::operator=(Odometry&&) noexcept = default;

void Odometry::CheckTimes(const Cloud& message) { odometry::CheckMessageTimes(message); }

OdometryResult Odometry::Add(const Cloud& sweep) { return impl_->Add(sweep); }

std::vector<StopPlace> Odometry::FindStops(const std::vector<const Cloud*>& sweeps,
                                           const OdometryOptions& options) {
  options.Check();
  Impl impl(options);
  std::vector<StopPlace> places;
  int worlds = 0, world = 0;
  std::size_t in_world = 0;
  for (const Cloud* cloud : sweeps) {
    Cloud standing = *cloud;
    standing.utime.clear();
    TimedSweep sweep = odometry::TimeSweep(standing, options);
    sweep.turned = true;
    if (impl.begun && impl.Found(sweep)) {
      ++in_world;
      places.push_back({world, impl.motion.world_from_lidar});
      continue;
    }
    places.push_back({worlds++, {}});
    // Of two that do not fit neither is better than the other: the newer one leads on.
    if ((impl.begun && in_world > 1) || sweep.points.size() < kFewestPoints) continue;
    impl.motion.world_from_lidar = Rigid3();
    impl.Begin(sweep);
    world = places.back().world;
    in_world = 1;
  }
  return places;
}

}  // namespace rgbdt
