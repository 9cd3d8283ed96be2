#pragma once

#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "services/drivers/dynamixel/motor_sweep.h"
#include "services/drivers/dynamixel/turning_motor.h"
#include "services/runtime/device_thread.h"

namespace rgbdt {

/// SESSION_COMMAND -> ENCODER, SESSION_EVENT: the motor that turns a 2D scanner.
///
/// The position is read every kPeriod as long as there is a servo, and published with the sweep
/// that it belongs to. On SWEEP the motor goes to the nearer end of its range, then turns to the
/// other; the sweep begins with the last reading before the motion, whose time is its name, and is
/// no longer named from the reading on at which the other end is reached. Events: kProgress at most
/// four times a second, kDone with the sweep's name, kFailed where the motor stands, is out of
/// reach, has stopped itself, does not answer or is busy; where a session was started anew in the
/// midst of a sweep, its own follows that one. A failure and the end switch the torque
/// off; a servo that has gone is looked for until it is back.
class MotorNode : public DeviceNode {
 public:
  static constexpr Utime kPeriod = 5000;  ///< between readings, where the line allows it
  static constexpr Utime kProgressPeriod = 250'000;

  /// Throws InputError, with what to add to the rig file, where there is no motor to drive.
  explicit MotorNode(const LidarSpec& lidar);

  std::string name() const override { return "motor"; }
  std::vector<std::string> Subscriptions() const override { return {"SESSION_COMMAND"}; }
  Messages Handle(const Message& message) override;
  Status GetStatus() const override;
  Messages Advance(Utime /*now*/) override { return TakeFrom(&thread_); }
  bool finished() const override { return thread_.ended(); }

 private:
  void Serve(DeviceThread* thread);
  void ServeMotor(TurningMotor* motor, DeviceThread* thread);
  void BeginSweep(TurningMotor* motor, DeviceThread* thread);
  void OnReading(const PositionReading& reading, TurningMotor* motor, DeviceThread* thread);
  void PublishProgress(Utime steady, DeviceThread* thread);
  void EndSweep(EventKind kind, const std::string& text, DeviceThread* thread);
  SessionEvent EventOf(std::int64_t command, EventKind kind, const std::string& text) const;
  void SetText(bool connected, const std::string& text);

  const TurnedScanner scanner_;
  MotorCounters counters_;
  std::atomic<std::int64_t> sweeps_{0};
  std::atomic<Utime> newest_{0};  // reading

  mutable std::mutex mutex_;  // guards these four
  bool connected_ = false;
  std::string text_ = "the servo is still being looked for";
  std::optional<std::int64_t> command_;       // of the sweep that is asked for or under way
  std::optional<std::int64_t> next_command_;  // another session's

  std::optional<MotorSweep> sweep_;  // the thread's own, as is the next
  Utime next_progress_ = 0;

  DeviceThread thread_;  // last: it uses all the others
};

}  // namespace rgbdt
