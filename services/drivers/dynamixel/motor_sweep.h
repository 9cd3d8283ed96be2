#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "calib/model/rig.h"
#include "services/drivers/dynamixel/turning_motor.h"

namespace rgbdt {

/// One sweep as a machine of readings: to the nearer end, then to the other one. No port, no clock
/// but the readings' own: how long something took is by their steady time, so that a wall clock
/// that is set does not stop a motor.
///
/// A goal is reached within kReached of it, or within kNear where the motor comes no nearer for
/// kSettled (its own control leaves a rest). Further away, no advance for kStalled is a stall.
class MotorSweep {
 public:
  static constexpr double kReachedRad = 0.0009, kNearRad = 0.009;  // 0.05 and 0.5 deg
  static constexpr Utime kSettled = kMicrosecondsPerSecond / 10;
  static constexpr Utime kStalled = kMicrosecondsPerSecond / 2;

  /// What follows from a reading.
  struct Step {
    std::optional<std::int64_t> move_to;  ///< [ticks], now
    Utime sweep_utime = 0;                ///< of the reading; 0: not within the sweep
    bool done = false;
    std::string failure;  ///< empty: none
  };

  MotorSweep(const TurnedScanner& scanner, std::int64_t command);

  Step Take(const PositionReading& reading);

  std::int64_t command() const { return command_; }
  /// Its name: the time of its first reading; 0 before.
  Utime sweep_utime() const { return sweep_utime_; }
  /// 0 to 1, of the sweep itself.
  double fraction() const { return fraction_; }
  /// For a person: "moving to the sweep's start".
  std::string Text() const;

 private:
  enum class Phase { kNew, kApproach, kSweep };

  std::int64_t TicksOf(double angle_rad) const { return TicksAt(scanner_, angle_rad); }
  void GoTo(std::int64_t goal, const PositionReading& reading, Step* step);
  void BeginSweep(const PositionReading& reading, Step* step);
  bool Arrived(const PositionReading& reading);
  std::string Stall(const PositionReading& reading) const;
  double Degrees(std::int64_t ticks) const;

  TurnedScanner scanner_;
  std::int64_t command_;
  Phase phase_ = Phase::kNew;
  std::int64_t start_ = 0, end_ = 0, goal_ = 0;  // [ticks]
  double nearest_ = 0;                           // to the goal so far [ticks]
  Utime advanced_ = 0;                           // when it last came nearer; steady
  Utime sweep_utime_ = 0;
  double fraction_ = 0;
};

}  // namespace rgbdt
