#include "services/drivers/dynamixel/motor_sweep.h"

#include <algorithm>
#include <cmath>

#include "calib/model/text.h"

namespace rgbdt {
namespace {

constexpr double kDegree = 3.14159265358979 / 180;

double Distance(std::int64_t a, std::int64_t b) { return std::abs(static_cast<double>(a - b)); }

}  // namespace

MotorSweep::MotorSweep(const TurnedScanner& scanner, std::int64_t command)
    : scanner_(scanner), command_(command) {}

double MotorSweep::Degrees(std::int64_t ticks) const {
  return (static_cast<double>(ticks) - scanner_.zero_ticks) / scanner_.ticks_per_rad / kDegree;
}

std::string MotorSweep::Text() const {
  if (phase_ != Phase::kSweep) return "moving to the sweep's start";
  return "sweeping to " + Fixed(Degrees(goal_), 1) + " deg";
}

void MotorSweep::GoTo(std::int64_t goal, const PositionReading& reading, Step* step) {
  goal_ = goal;
  nearest_ = Distance(reading.ticks, goal);
  advanced_ = reading.steady;
  step->move_to = goal;
}

void MotorSweep::BeginSweep(const PositionReading& reading, Step* step) {
  phase_ = Phase::kSweep;
  sweep_utime_ = reading.utime;
  GoTo(end_, reading, step);
}

MotorSweep::Step MotorSweep::Take(const PositionReading& reading) {
  Step step;
  if (phase_ == Phase::kNew) {
    start_ = TicksOf(scanner_.motor->from_rad);
    end_ = TicksOf(scanner_.motor->to_rad);
    if (Distance(reading.ticks, end_) < Distance(reading.ticks, start_)) std::swap(start_, end_);
    phase_ = Phase::kApproach;
    GoTo(start_, reading, &step);
  }
  if (Arrived(reading)) {
    if (phase_ == Phase::kApproach) {
      BeginSweep(reading, &step);
    } else {
      step.done = true;
    }
  } else {
    step.failure = Stall(reading);
  }
  if (phase_ == Phase::kSweep) {
    fraction_ = std::min(1.0, Distance(reading.ticks, start_) / Distance(end_, start_));
    if (!step.done && step.failure.empty()) step.sweep_utime = sweep_utime_;
  }
  return step;
}

// To advance is to come nearer by more than the encoder's noise: 2.5% of a second's way.
bool MotorSweep::Arrived(const PositionReading& reading) {
  const double ticks_per_rad = std::abs(scanner_.ticks_per_rad);
  const double advance = std::max(1.0, 0.025 * scanner_.motor->speed_rad_s * ticks_per_rad);
  const double distance = Distance(reading.ticks, goal_);
  if (distance <= nearest_ - advance) {
    nearest_ = distance;
    advanced_ = reading.steady;
  }
  if (distance <= std::max(1.0, kReachedRad * ticks_per_rad)) return true;
  return distance <= kNearRad * ticks_per_rad && reading.steady - advanced_ >= kSettled;
}

std::string MotorSweep::Stall(const PositionReading& reading) const {
  if (reading.steady - advanced_ < kStalled) return "";
  return "the motor stands at " + Fixed(Degrees(reading.ticks), 1) + " deg on its way to " +
         Fixed(Degrees(goal_), 1) +
         " deg; its torque is off now: see what blocks it, and whether it has power";
}

}  // namespace rgbdt
