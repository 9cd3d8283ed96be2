#include "calib/odometry/internal/loop_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "calib/odometry/internal/registration.h"

namespace rgbdt::odometry {
namespace {

// What is known of the place before: 1 sigma.
constexpr double kPlace = 2;         // [m]
constexpr double kTurn = 0.2;        // [rad]
constexpr double kSpeed = 0.05;      // [m/s]
constexpr double kTurnSpeed = 0.02;  // [rad/s]

// Beyond these it is no loop: a wrong one spoils the map, one that is missed leaves it as it was.
constexpr double kMostMoved = 4;         // [m] from the start
constexpr double kMostTurned = 0.25;     // [rad]
constexpr double kLeastOverlap = 0.5;    // of all points
constexpr double kLeastFit = 0.9;        // of the points that lie near a plane
constexpr double kMostResidual = 0.012;  // [m] from the planes, median; or, as ranges may be
constexpr double kMostOfOdometry = 1.3;  // noisier, so many times what it is on odometry's map

// What both maps' planes are off by, 1 sigma.
constexpr double kCommonPlace = 0.01;              // [m]
constexpr double kCommonTurn = 0.03 * M_PI / 180;  // [rad]

Motion Start(const Rigid3& old_from_new, const Vector6d& velocity) {
  Motion motion;
  motion.world_from_lidar = old_from_new;
  motion.velocity = velocity;
  Vector12d sigma;
  sigma << Eigen::Vector3d::Constant(kTurn), Eigen::Vector3d::Constant(kPlace),
      Eigen::Vector3d::Constant(kTurnSpeed), Eigen::Vector3d::Constant(kSpeed);
  motion.covariance.diagonal() = sigma.cwiseAbs2();
  return motion;
}

std::string Text(const char* format, double value) {
  char text[120];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string WhyNot(const LoopCheck& found, const Registration& registered, const Rigid3& start,
                   const Keyframe& frame) {
  if (!registered.converged) return "the sweep does not settle on the map";
  if (registered.degenerate.cols() > 0) return "what stands about does not tell every direction";
  const Rigid3 moved = start.Inverse() * found.old_from_new;
  if (moved.translation.norm() > kMostMoved || RotationDistance(moved, {}) > kMostTurned) {
    return Text("it fits only %.1f m from where it was looked for", moved.translation.norm());
  }
  if (found.overlap < kLeastOverlap) {
    return Text("%.0f%% of the sweep lie on what was seen before", 100 * found.overlap);
  }
  if (found.fit < kLeastFit) return Text("%.0f%% of the points fit their planes", 100 * found.fit);
  if (found.residual_m > std::max(kMostResidual, kMostOfOdometry * frame.residual_m)) {
    return Text("points lie %.0f mm off their planes", 1e3 * found.residual_m);
  }
  return "";
}

LoopCheck CheckFrom(const Rigid3& start, const PlaneMap& map, const Keyframe& frame,
                    const OdometryOptions& options) {
  // Hardly anything is known.
  const Motion before = Start(start, frame.velocity);
  const Registration found = Register(frame.sweep, map, before, before, Untold::kAtTheEnd, options);
  LoopCheck check;
  check.old_from_new = found.motion.world_from_lidar;
  Vector6d common;
  common << Eigen::Vector3d::Constant(kCommonTurn), Eigen::Vector3d::Constant(kCommonPlace);
  check.covariance = found.motion.covariance.topLeftCorner<6, 6>();
  check.covariance.diagonal() += common.cwiseAbs2();
  check.overlap = static_cast<double>(found.matched) /
                  static_cast<double>(std::max<std::size_t>(1, frame.sweep.selected.size()));
  check.fit = found.fit;
  check.residual_m = found.residual_m;
  check.why_not = WhyNot(check, found, start, frame);
  return check;
}

}  // namespace

LoopCheck CheckLoop(const PlaneMap& map, const Keyframe& frame, const std::vector<Rigid3>& starts,
                    const OdometryOptions& options) {
  LoopCheck best;
  best.why_not = "nowhere to start from";
  for (const Rigid3& start : starts) {
    LoopCheck check = CheckFrom(start, map, frame, options);
    if (check.why_not.empty()) return check;
    if (check.overlap * check.fit >= best.overlap * best.fit) best = std::move(check);
  }
  return best;
}

}  // namespace rgbdt::odometry
