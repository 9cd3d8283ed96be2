#include "services/drivers/dynamixel/motor_node.h"

#include <pthread.h>
#include <sched.h>

#include <chrono>
#include <thread>
#include <utility>

#include "calib/model/errors.h"

namespace rgbdt {
namespace {

constexpr std::int64_t kReadingsToJudgeBy = 200;
constexpr int kMaxBehind = 10;  // readings

// A reading's time is known as well as this thread is woken in time. Where the priority may not be
// had (it needs the right to, `ulimit -r`), more readings are left out on a busy machine.
void TakePriority() {
  sched_param priority{};
  priority.sched_priority = 1;
  pthread_setschedparam(pthread_self(), SCHED_RR, &priority);
}

// Whose session's it is (SessionCommand).
std::int64_t SessionOf(std::int64_t command) { return command >> 32; }

void WarnIfAny(const std::string& warning, DeviceThread* thread) {
  if (!warning.empty()) thread->Warn(warning);
}

const TurnedScanner& WithMotor(const LidarSpec& lidar) {
  if (!lidar.turned_scanner) {
    throw InputError("the rig's lidar has no turned_scanner, so there is no motor to drive");
  }
  if (!lidar.turned_scanner->motor) {
    throw InputError(
        "the rig's lidar.turned_scanner has no dynamixel section; add to it, with your own values: "
        "dynamixel { port: \"/dev/ttyUSB0\" baud: 57600 id: 1 from_deg: -90 to_deg: 90 "
        "speed_deg_s: 20 }");
  }
  return *lidar.turned_scanner;
}

}  // namespace

MotorNode::MotorNode(const LidarSpec& lidar)
    : scanner_(WithMotor(lidar)), thread_([this](DeviceThread& thread) { Serve(&thread); }) {}

SessionEvent MotorNode::EventOf(std::int64_t command, EventKind kind,
                                const std::string& text) const {
  SessionEvent event;
  event.command = command;
  event.utime = newest_;
  event.source = name();
  event.kind = kind;
  event.text = text;
  return event;
}

void MotorNode::SetText(bool connected, const std::string& text) {
  const std::lock_guard<std::mutex> lock(mutex_);
  connected_ = connected;
  text_ = text;
}

Messages MotorNode::Handle(const Message& message) {
  const auto* command = std::get_if<SessionCommand>(&message);
  if (command == nullptr || command->verb != SessionVerb::kSweep) return {};
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!connected_) return {EventOf(command->command, EventKind::kFailed, text_)};
  if (command_ && SessionOf(*command_) != SessionOf(command->command)) {
    next_command_ = command->command;
    return {};
  }
  if (command_) {
    return {EventOf(command->command, EventKind::kFailed,
                    "the motor is busy with the sweep of command " + std::to_string(*command_) +
                        "; ask again when that is done")};
  }
  command_ = command->command;
  return {};
}

void MotorNode::Serve(DeviceThread* thread) {
  TakePriority();
  try {
    TurningMotor motor(scanner_, &counters_);
    WarnIfAny(motor.WhyOutOfReach(), thread);
    SetText(true, motor.model_name() + " on " + scanner_.motor->port + ", waits for a command");
    ServeMotor(&motor, thread);
  } catch (const std::exception& e) {
    SetText(false, e.what());
    EndSweep(EventKind::kFailed, e.what(), thread);
    throw;
  }
}

void MotorNode::ServeMotor(TurningMotor* motor, DeviceThread* thread) {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::microseconds period(kPeriod);
  auto due = Clock::now();
  for (std::int64_t readings = 0; !thread->Stopping();) {
    BeginSweep(motor, thread);
    const auto reading = motor->Read();
    if (!reading) continue;  // the next try at once
    OnReading(*reading, motor, thread);
    if (++readings == kReadingsToJudgeBy) WarnIfAny(motor->WhyPoorReadings(), thread);
    // What was held up is made good, but not without end.
    due = std::max(due + period, Clock::now() - kMaxBehind * period);
    std::this_thread::sleep_until(due);
  }
}

void MotorNode::BeginSweep(TurningMotor* motor, DeviceThread* thread) {
  if (sweep_) return;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!command_) return;
    sweep_.emplace(scanner_, *command_);
  }
  next_progress_ = 0;
  const std::string out_of_reach = motor->WhyOutOfReach();
  if (out_of_reach.empty()) {
    motor->Start();
  } else {
    EndSweep(EventKind::kFailed, out_of_reach, thread);
  }
}

void MotorNode::OnReading(const PositionReading& reading, TurningMotor* motor,
                          DeviceThread* thread) {
  newest_ = reading.utime;
  MotorSweep::Step step;
  if (sweep_) step = sweep_->Take(reading);
  EncoderReading message;
  message.utime = reading.utime;
  message.ticks = reading.ticks;
  message.sweep_utime = step.sweep_utime;
  thread->Publish(message);
  if (step.move_to) motor->MoveTo(*step.move_to);
  if (!sweep_) return;
  if (step.done) {
    ++sweeps_;
    EndSweep(EventKind::kDone, "sweep complete", thread);
  } else if (!step.failure.empty()) {
    motor->TorqueOff();
    EndSweep(EventKind::kFailed, step.failure, thread);
  } else {
    PublishProgress(reading.steady, thread);
  }
}

void MotorNode::PublishProgress(Utime steady, DeviceThread* thread) {
  if (steady < next_progress_) return;
  next_progress_ = steady + kProgressPeriod;
  SessionEvent event = EventOf(sweep_->command(), EventKind::kProgress, sweep_->Text());
  event.sweep_utime = sweep_->sweep_utime();
  event.fraction = sweep_->fraction();
  thread->Publish(event);
}

// Also of a sweep that was asked for and has not begun.
void MotorNode::EndSweep(EventKind kind, const std::string& text, DeviceThread* thread) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!command_) return;
  SessionEvent event = EventOf(*command_, kind, text);
  event.fraction = kind == EventKind::kDone ? 1 : 0;
  if (kind == EventKind::kDone && sweep_) event.sweep_utime = sweep_->sweep_utime();
  thread->Publish(event);
  sweep_.reset();
  command_ = std::exchange(next_command_, std::nullopt);
}

Status MotorNode::GetStatus() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  Status status;
  status.ready = connected_;
  status.text = connected_ && command_ ? "turns for command " + std::to_string(*command_) : text_;
  status.counters = {{"readings", counters_.readings},           {"left out", counters_.left_out},
                     {"bad checksums", counters_.bad_checksums}, {"time-outs", counters_.timeouts},
                     {"round trip us", counters_.round_trip_us}, {"sweeps", sweeps_}};
  return status;
}

}  // namespace rgbdt
