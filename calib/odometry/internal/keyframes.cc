#include "calib/odometry/internal/keyframes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace rgbdt::odometry {
namespace {

// What planes are off by is common to both ends of a short way: 1 sigma.
constexpr double kCommonTurn = 1e-5;  // [rad]
constexpr double kCommon = 1e-3;      // [m]

// The way over a restart is a guess, 1 sigma.
constexpr double kGuessed = 10;       // [m]
constexpr double kGuessedTurn = 0.5;  // [rad]

Matrix6d Diagonal(double turn_rad, double place_m) {
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(turn_rad), Eigen::Vector3d::Constant(place_m);
  return sigma.cwiseAbs2().asDiagonal();
}

void Thin(std::vector<TimedPoint>* points, std::size_t most) {
  if (points->size() > most) {
    for (std::size_t i = 0; i < most; ++i) (*points)[i] = (*points)[i * points->size() / most];
    points->resize(most);
  }
  points->shrink_to_fit();
}

std::optional<Place> PlaceIn(const TimedSweep& sweep, const Vector6d& velocity) {
  const SweepMotion motion({}, velocity, sweep.seconds);
  std::vector<Eigen::Vector3d> points;
  points.reserve(sweep.points.size());
  for (const TimedPoint& p : sweep.points) points.push_back(motion.InMiddle(p));
  return PlaceOf(points);
}

// A turned scanner's sweep, as if seen from where the LIDAR was in its middle; without points that
// are the rig's own or too far away, and those of which the way does not tell.
TimedSweep Straightened(Cloud cloud, const OdometryResult& found, OdometryOptions options) {
  const Rigid3 middle_from_world = found.world_from_middle.Inverse();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto after =
        std::lower_bound(found.way.begin(), found.way.end(), cloud.utime[i],
                         [](const PoseAtTime& pose, Utime utime) { return pose.utime < utime; });
    const float range = cloud.points[i].norm();
    const bool of_use = range >= static_cast<float>(options.min_range_m) &&
                        range <= static_cast<float>(options.max_range_m);
    if (!of_use || after == found.way.begin() || after == found.way.end()) {
      cloud.points[i].setConstant(std::numeric_limits<float>::quiet_NaN());
      continue;
    }
    const PoseAtTime& before = *(after - 1);
    const double share =
        ToSeconds(cloud.utime[i] - before.utime) / ToSeconds(after->utime - before.utime);
    const Vector6d step = share * Log(before.world_from_lidar.Inverse() * after->world_from_lidar);
    const Rigid3 middle_from_own = middle_from_world * before.world_from_lidar * Exp(step);
    cloud.points[i] =
        (middle_from_own * Eigen::Vector3d(cloud.points[i].cast<double>())).cast<float>();
  }
  cloud.utime.clear();
  options.min_range_m = 0.05;  // near the middle's place may be what was far away
  options.max_range_m = 2 * options.max_range_m;
  TimedSweep sweep = TimeSweep(cloud, options);
  sweep.first = found.first_utime;
  sweep.middle = found.middle_utime;
  sweep.last = found.utime;
  return sweep;
}

}  // namespace

bool KeyframeStore::IsFar(const OdometryResult& found) const {
  if (frames_.empty() || unknown_) return true;
  const Rigid3 moved = frames_.back().world_from_middle.Inverse() * found.world_from_middle;
  return moved.translation.norm() >= apart_ * options_.keyframe_m ||
         RotationDistance(moved, {}) >= apart_ * options_.keyframe_rad;
}

// Both places' errors against odometry's own map make up what the way between them is off by.
void KeyframeStore::AddEdge(const OdometryResult& found, double* way_m) {
  const Keyframe& before = frames_.back();
  PoseEdge edge;
  edge.from = frames_.size() - 1;
  edge.to = frames_.size();
  edge.from_from_to = before.world_from_middle.Inverse() * found.world_from_middle;
  const Matrix6d onward = Adjoint(edge.from_from_to.Inverse());
  edge.covariance = onward * before.covariance * onward.transpose() + found.covariance +
                    Diagonal(kCommonTurn, kCommon);
  if (unknown_) edge.covariance += Diagonal(kGuessedTurn, kGuessed);
  chain_.push_back(edge);
  *way_m = before.way_m + edge.from_from_to.translation.norm();
}

void KeyframeStore::Add(const Cloud& cloud, const OdometryResult& found) {
  unknown_ = unknown_ || (found.restarted && !frames_.empty());
  if (!found.converged || !IsFar(found)) return;
  Keyframe frame;
  const bool drove = !found.way.empty();
  frame.sweep = drove ? Straightened(cloud, found, odometry_) : TimeSweep(cloud, odometry_);
  frame.velocity = drove ? Vector6d(Vector6d::Zero()) : found.velocity;
  const auto place = PlaceIn(frame.sweep, frame.velocity);
  if (!place) return;
  frame.place = *place;
  Thin(&frame.sweep.points, options_.map_points);
  frame.world_from_middle = found.world_from_middle;
  frame.covariance = found.covariance;
  frame.residual_m = found.residual_m;
  if (!frames_.empty()) AddEdge(found, &frame.way_m);
  unknown_ = false;
  frames_.push_back(std::move(frame));
  // The last one stays, so that the way from it on is what it was.
  if (frames_.size() > options_.max_keyframes && frames_.size() % 2 == 1) Halve();
}

void KeyframeStore::Halve() {
  std::vector<PoseEdge> chain;
  for (std::size_t i = 0; i + 1 < chain_.size(); i += 2) {
    chain.push_back(Chained(chain_[i], chain_[i + 1]));
    chain.back().from = i / 2;
    chain.back().to = i / 2 + 1;
  }
  chain_ = std::move(chain);
  for (std::size_t i = 0; 2 * i < frames_.size(); ++i) {
    if (i > 0) frames_[i] = std::move(frames_[2 * i]);
  }
  frames_.resize((frames_.size() + 1) / 2);
  apart_ *= 2;
}

PoseEdge KeyframeStore::Between(std::size_t from, std::size_t to) const {
  if (from > to) return Inverted(Between(to, from));
  PoseEdge edge{from, from, {}, Diagonal(kCommonTurn, kCommon)};
  for (std::size_t i = from; i < to; ++i) edge = Chained(edge, chain_[i]);
  return edge;
}

PoseEdge KeyframeStore::ByOdometry(std::size_t from, std::size_t to) const {
  PoseEdge edge = Between(from, to);
  const double metres = frames_[to].way_m - frames_[from].way_m;
  edge.covariance += Diagonal(metres * options_.drift_radpm, metres * options_.drift_share);
  return edge;
}

PlaneMap KeyframeStore::MapAbout(std::size_t index) const {
  PlaneMap map(odometry_.range_sigma_m);
  const Rigid3 own_from_world = frames_[index].world_from_middle.Inverse();
  for (const Keyframe& frame : frames_) {
    if (std::abs(frame.way_m - frames_[index].way_m) > options_.about_m) continue;
    const Rigid3 own_from_middle = own_from_world * frame.world_from_middle;
    map.Add(InWorld(frame.sweep, SweepMotion(own_from_middle, frame.velocity, frame.sweep.seconds)),
            own_from_middle.translation);
  }
  return map;
}

}  // namespace rgbdt::odometry
