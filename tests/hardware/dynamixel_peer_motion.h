#pragma once

#include <map>
#include <optional>

namespace rgbdt::test {

/// Where something is on its way, for any time: pieces of constant acceleration.
class PeerMotion {
 public:
  explicit PeerMotion(double position) { pieces_[0] = {position, 0, 0}; }
  double PositionAt(double utime) const;
  double VelocityAt(double utime) const;  ///< [ticks/s]
  /// From `now` on to the goal, no faster than `speed` [ticks/s]; it stops at `wall`, if there.
  void GoTo(double goal, double now, double speed, double acceleration, std::optional<double> wall);
  void Stop(double now);

 private:
  struct Piece {
    double position, velocity, acceleration;  // at its begin; [ticks], [/s], [/s^2]
  };
  void Cut(double now);
  void StopAtWall(double wall, double now);

  std::map<double, Piece> pieces_;  // by the time of their begin [us]
};

}  // namespace rgbdt::test
