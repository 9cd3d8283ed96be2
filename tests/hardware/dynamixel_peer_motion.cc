#include "tests/hardware/dynamixel_peer_motion.h"

#include <algorithm>
#include <cmath>

namespace rgbdt::test {

double PeerMotion::PositionAt(double utime) const {
  const auto next = pieces_.upper_bound(utime);
  const auto& [begin, piece] = *std::prev(next);
  const double t = (utime - begin) / 1e6;
  return piece.position + piece.velocity * t + piece.acceleration * t * t / 2;
}

double PeerMotion::VelocityAt(double utime) const {
  const auto& [begin, piece] = *std::prev(pieces_.upper_bound(utime));
  return piece.velocity + piece.acceleration * (utime - begin) / 1e6;
}

void PeerMotion::Cut(double now) { pieces_.erase(pieces_.upper_bound(now), pieces_.end()); }

void PeerMotion::Stop(double now) {
  const double position = PositionAt(now);
  Cut(now);
  pieces_[now] = {position, 0, 0};
}

// Faster to `speed`, on, slower to rest; a short way has no middle piece. A motion that is under
// way is stopped first: the scripts do not turn about in full swing.
void PeerMotion::GoTo(double goal, double now, double speed, double acceleration,
                      std::optional<double> wall) {
  Stop(now);
  const double position = PositionAt(now);
  const double sign = goal < position ? -1 : 1;
  const double way = std::abs(goal - position);
  const double peak = std::min(speed, std::sqrt(way * acceleration));
  const double ramp_s = peak / acceleration;
  const double cruise_s = peak > 0 ? std::max(0.0, way / peak - ramp_s) : 0;
  const double ramp_way = peak * ramp_s / 2;
  const double cruise = now + ramp_s * 1e6, slower = cruise + cruise_s * 1e6;
  if (way == 0) return;
  pieces_[now] = {position, 0, sign * acceleration};
  pieces_[cruise] = {position + sign * ramp_way, sign * peak, 0};
  pieces_[slower] = {goal - sign * ramp_way, sign * peak, -sign * acceleration};
  pieces_[slower + ramp_s * 1e6] = {goal, 0, 0};
  if (wall) StopAtWall(*wall, now);
}

void PeerMotion::StopAtWall(double wall, double now) {
  double before = now, after = pieces_.rbegin()->first;
  const bool below = PositionAt(before) < wall;
  if (below == (PositionAt(after) < wall)) return;
  while (after - before > 1) {
    const double middle = (before + after) / 2;
    (below == (PositionAt(middle) < wall) ? before : after) = middle;
  }
  Stop(before);
}

}  // namespace rgbdt::test
