#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>

#include "calib/model/rig.h"
#include "calib/model/time.h"
#include "services/drivers/dynamixel/dynamixel_models.h"
#include "services/drivers/dynamixel/dynamixel_protocol.h"
#include "services/drivers/dynamixel/round_trips.h"
#include "services/drivers/dynamixel/serial_port.h"

namespace rgbdt {

/// What a motor has done, for its status; counted by its thread, read by another.
struct MotorCounters {
  std::atomic<std::int64_t> readings{0};
  std::atomic<std::int64_t> left_out{0};       ///< readings: their time is not known well enough
  std::atomic<std::int64_t> bad_checksums{0};  ///< answers
  std::atomic<std::int64_t> timeouts{0};       ///< answers that did not come
  std::atomic<std::int64_t> round_trip_us{0};  ///< of a reading, beside the time on the wire
};

struct PositionReading {
  Utime utime = 0;  ///< when the servo took it
  std::int64_t ticks = 0;
  Utime steady = 0;  ///< the same moment by the machine's steady clock, for durations
};

/// The Dynamixel servo that turns the scanner, over its serial port. Everything that goes wrong is
/// a DeviceError that says what to do. The torque is off until Start() and after the destructor.
///
/// A reading's time is the middle between the moment at which the request had left and the moment
/// at which the answer began: the servo takes its position between the two, so the error is at
/// most half of what lies between them. Two things keep that short: the servo's Return Delay Time
/// is set to 0 (it is up to 0.5 ms, and nobody says on which side of it the position is taken), and
/// a reading that took longer than usual, because somebody was not woken in time, is left out; the
/// best of those is taken only where there was no other for kMaxGapUs.
class TurningMotor {
 public:
  static constexpr int kMaxMissing = 20;               ///< answers in a row, then the servo is gone
  static constexpr std::int64_t kAnswerUs = 30'000;    ///< beside the time on the wire
  static constexpr double kMaxGapUs = 60'000;          ///< between readings
  static constexpr double kMaxReadingUs = 8'000;       ///< on the wire, for 100 readings a second
  static constexpr double kMaxRoundTripUs = 1'000;     ///< beside the time on the wire
  static constexpr double kAccelerationSeconds = 0.2;  ///< from rest to the set speed

  /// Opens the port, finds the servo and makes it ready, its torque off. `counters` live longer.
  TurningMotor(const TurnedScanner& scanner, MotorCounters* counters);
  /// Torque off, as well as it can.
  ~TurningMotor();
  TurningMotor(const TurningMotor&) = delete;
  TurningMotor& operator=(const TurningMotor&) = delete;

  std::string model_name() const { return model_->name; }
  /// Why the servo does not reach the rig's two ends; empty: it does.
  std::string WhyOutOfReach() const;
  /// Why its readings are too few or their times not known well; empty: they are not.
  std::string WhyPoorReadings() const;

  /// Nothing where the answer was lost, or late or early; the next one may be asked for at once.
  std::optional<PositionReading> Read();
  /// Torque on where it stands, with the rig's speed.
  void Start();
  void MoveTo(std::int64_t ticks);
  /// Never throws: what cannot be reached cannot be switched off.
  void TorqueOff() noexcept;

 private:
  using Entry = dynamixel::ControlTable::Entry;
  struct Answer {
    dynamixel::Status status;
    double left_us = 0, began_us = 0;  ///< request had left, answer began; steady clock
  };

  struct Timed {
    double steady_us = 0, trip_us = 0;
    std::int64_t ticks = 0;
  };

  /// With as many parameters in the answer, unless that is a refusal. Nothing: none came.
  std::optional<Answer> AskOnce(const dynamixel::Bytes& request, std::size_t parameters);
  dynamixel::Status Ask(const dynamixel::Bytes& request, std::size_t parameters);
  void WaitForQuiet();
  PositionReading Publish(const Timed& reading);
  void CheckMissing() const;
  void CheckStatus(const dynamixel::Status& status, const std::string& what);
  [[noreturn]] void FailOnAlert();
  std::int64_t Get(Entry entry);
  void Set(Entry entry, std::int64_t value, const std::string& what);
  void Prepare();
  void CheckModes();
  [[noreturn]] void Fail(const std::string& what) const;

  TurnedScanner scanner_;
  DynamixelDevice device_;
  MotorCounters* counters_;
  SerialPort port_;
  dynamixel::StatusDecoder decoder_;
  const dynamixel::Model* model_ = nullptr;
  RoundTrips round_trips_;
  double newest_us_ = 0;                // reading; steady clock
  std::optional<Timed> best_left_out_;  // since then
  int missing_ = 0;                     // answers in a row
  bool limited_ = true;
  std::int64_t min_ticks_ = 0, max_ticks_ = 0;
};

/// The reading at an angle of the motor.
std::int64_t TicksAt(const TurnedScanner& scanner, double angle_rad);

}  // namespace rgbdt
