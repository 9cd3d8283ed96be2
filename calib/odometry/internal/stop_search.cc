#include "calib/odometry/internal/stop_search.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rgbdt::odometry {
namespace {

constexpr double kStep = 0.4;         // [m] of the grid
constexpr int kHeadings = 48;         // of it
constexpr std::size_t kPoints = 300;  // looked at, about
constexpr double kNear = 0.4;         // [m] of a plane: what is farther does not count
// What is as near to a likelier place is that one's neighbour in the grid.
constexpr double kBeside = 1.1 * kStep, kBesideTurned = 1.1 * 2 * M_PI / kHeadings;

constexpr std::size_t kStarts = 16;  // registered from so many
constexpr double kReach = 2.4;       // [m] how far away it is looked for
constexpr int kMostReach = 3;        // so many times as far at most, after stops that were missed
constexpr double kSamePlace = 0.3;   // [m]
constexpr double kSameTurn = 0.2;    // [rad]
constexpr double kAsGood = 0.93;     // of the points near a plane: another place is as good

// Between two stops: 1 sigma.
constexpr double kWay = 1.5;      // [m]
constexpr double kTurn = 2;       // [rad] about the vertical
constexpr double kTilt = 0.1;     // [rad]
constexpr double kStands = 1e-4;  // [m/s], [rad/s]

struct Candidate {
  Rigid3 place;
  double score = 0;
};

bool IsNear(const Rigid3& a, const Rigid3& b, double metres, double radians) {
  return (a.translation - b.translation).norm() <= metres &&
         a.rotation.angularDistance(b.rotation) <= radians;
}

// The likeliest first.
std::vector<Rigid3> LikelyPlaces(const TimedSweep& sweep, const PlaneMap& map, const Rigid3& last,
                                 double reach_m) {
  std::vector<Eigen::Vector3d> points;
  const std::size_t every = std::max<std::size_t>(1, sweep.selected.size() / kPoints);
  points.reserve(sweep.selected.size() / every + 1);
  for (std::size_t i = 0; i < sweep.selected.size(); i += every) {
    points.emplace_back(sweep.selected[i].point.cast<double>());
  }
  const int steps = static_cast<int>(std::ceil(reach_m / kStep));
  std::vector<Candidate> candidates;
  for (int heading = 0; heading < kHeadings; ++heading) {
    Rigid3 turned = last * RotationAbout(Eigen::Vector3d::UnitZ(), heading * 2 * M_PI / kHeadings);
    const Eigen::Matrix3d rotation = turned.rotation.toRotationMatrix();
    std::vector<Eigen::Vector3d> rotated;
    rotated.reserve(points.size());
    for (const Eigen::Vector3d& p : points) rotated.emplace_back(rotation * p);
    for (int x = -steps; x <= steps; ++x) {
      for (int y = -steps; y <= steps; ++y) {
        const Eigen::Vector3d moved = kStep * Eigen::Vector3d(x, y, 0);
        if (moved.norm() > reach_m) continue;
        turned.translation = last.translation + moved;
        double score = 0;
        for (const Eigen::Vector3d& p : rotated) {
          const Eigen::Vector3d at = p + turned.translation;
          const Match match = map.Find(at);
          if (match.plane == nullptr) continue;
          const double off = std::abs(match.plane->normal.dot(at - match.plane->mean));
          score += std::max(0.0, 1 - off / kNear);
        }
        candidates.push_back({turned, score});
      }
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
  std::vector<Rigid3> places;
  for (const Candidate& candidate : candidates) {
    if (places.size() >= kStarts) break;
    const bool taken = std::any_of(places.begin(), places.end(), [&](const Rigid3& place) {
      return IsNear(place, candidate.place, kBeside, kBesideTurned);
    });
    if (!taken) places.push_back(candidate.place);
  }
  return places;
}

}  // namespace

Motion AfterStop(Motion motion, int lost) {
  const double more = 1 + lost;
  Vector12d sigma;
  sigma << kTilt, kTilt, more * kTurn, Eigen::Vector3d::Constant(more * kWay),
      Vector6d::Constant(kStands);
  motion.velocity.setZero();
  motion.covariance.setZero();
  motion.covariance.diagonal() = sigma.cwiseAbs2();
  return motion;
}

Motion SetOff(Motion motion) {
  constexpr double kSpeed = 0.5;                     // [m/s]
  constexpr double kTurning = 0.2;                   // [rad/s]
  if (!motion.velocity.isZero(1e-9)) return motion;  // it drives
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(kTurning), Eigen::Vector3d::Constant(kSpeed);
  const Matrix6d place = motion.covariance.topLeftCorner<6, 6>();
  motion.covariance.setZero();
  motion.covariance.topLeftCorner<6, 6>() = place;
  motion.covariance.bottomRightCorner<6, 6>().diagonal() = sigma.cwiseAbs2();
  return motion;
}

Stop FindStop(const TimedSweep& sweep, const PlaneMap& map, const Motion& before, int lost,
              const OdometryOptions& options) {
  Stop stop;
  std::vector<Registration> all;
  for (const Rigid3& place :
       LikelyPlaces(sweep, map, before.world_from_lidar, std::min(1 + lost, kMostReach) * kReach)) {
    Motion start = before;
    start.world_from_lidar = place;
    all.push_back(Register(sweep, map, before, start, Untold::kAtTheEnd, options));
    const Registration& found = all.back();
    const auto worth = [](const Registration& r) { return std::make_pair(r.converged, r.near); };
    if (worth(found) > worth(stop.best)) stop.best = found;
  }
  for (const Registration& other : all) {
    const Rigid3& place = other.motion.world_from_lidar;
    if (!other.converged) continue;
    if (IsNear(place, stop.best.motion.world_from_lidar, kSamePlace, kSameTurn)) continue;
    if (static_cast<double>(other.near) < kAsGood * static_cast<double>(stop.best.near)) continue;
    stop.other = place;
  }
  return stop;
}

}  // namespace rgbdt::odometry
