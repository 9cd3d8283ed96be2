#include "services/drivers/dynamixel/turning_motor.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "calib/model/text.h"
#include "services/posix/clock.h"
#include "services/runtime/device_thread.h"

namespace rgbdt {
namespace {

using dynamixel::Bytes;

constexpr double kTwoPi = 6.283185307179586;
constexpr int kTorqueOffTries = 3;
constexpr double kMaxLongerUs = 4'000;  // of a trip that is better than none
constexpr std::int64_t kQuietUs = 15'000;
constexpr double kMaxGapUs = 30'000;     // between readings
constexpr double kBitsPerByte = 10;      // start, eight, stop
constexpr std::size_t kStatusSize = 11;  // a status packet without parameters
constexpr int kPosition = 3, kExtendedPosition = 4;
constexpr int kTimeBasedProfile = 4;

double SteadyUs() {
  using Us = std::chrono::duration<double, std::micro>;
  return Us(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// UTC of a moment of the steady clock that lies just behind us. The wall clock is read between two
// readings of the steady one, anew where the machine did something else in between.
Utime ToUtime(double steady_us) {
  constexpr int kTries = 3;
  constexpr double kClose = 5;  // [us]
  double apart = std::numeric_limits<double>::infinity();
  Utime utime = 0;
  for (int i = 0; i < kTries && apart > kClose; ++i) {
    const double before = SteadyUs();
    const Utime utc = HostUtime();
    const double after = SteadyUs();
    if (after - before >= apart) continue;
    apart = after - before;
    utime = utc - std::llround((before + after) / 2 - steady_us);
  }
  return utime;
}

std::string Degrees(const TurnedScanner& scanner, std::int64_t ticks) {
  const double angle = (static_cast<double>(ticks) - scanner.zero_ticks) / scanner.ticks_per_rad;
  return Fixed(angle * 360 / kTwoPi, 1);
}

}  // namespace

std::int64_t TicksAt(const TurnedScanner& scanner, double angle_rad) {
  return std::llround(scanner.zero_ticks + angle_rad * scanner.ticks_per_rad);
}

TurningMotor::TurningMotor(const TurnedScanner& scanner, MotorCounters* counters)
    : scanner_(scanner),
      device_(scanner.motor.value()),
      counters_(counters),
      port_(device_.port, device_.baud) {
  try {
    Prepare();
  } catch (...) {
    TorqueOff();
    throw;
  }
}

TurningMotor::~TurningMotor() { TorqueOff(); }

void TurningMotor::Fail(const std::string& what) const {
  throw DeviceError("servo " + std::to_string(device_.id) + " on " + device_.port + ": " + what);
}

void TurningMotor::Prepare() {
  const dynamixel::Status pong = Ask(dynamixel::EncodePing(device_.id), 3);
  if (pong.parameters.size() != 3) {
    Fail("refuses a ping: " + dynamixel::ErrorInWords(pong.ErrorNumber()));
  }
  const int number = pong.parameters[0] + 256 * pong.parameters[1];
  model_ = dynamixel::FindModel(number);
  if (model_ == nullptr) {
    Fail("model number " + std::to_string(number) +
         " is not known; its control table would have to be added to dynamixel_models.cc");
  }
  CheckStatus(pong, "a ping");
  const dynamixel::ControlTable& table = *model_->table;
  Set(table.torque_enable, 0, "torque off");
  if (Get(table.return_delay) != 0) Set(table.return_delay, 0, "Return Delay Time 0");
  CheckModes();
}

void TurningMotor::CheckModes() {
  const dynamixel::ControlTable& table = *model_->table;
  const std::int64_t mode = Get(table.operating_mode);
  if (mode != kPosition && mode != kExtendedPosition) {
    Fail("its Operating Mode is " + std::to_string(mode) +
         "; set it to 3 (position) or 4 (extended position), e.g. with DYNAMIXEL Wizard");
  }
  if (table.drive_mode.size != 0 && (Get(table.drive_mode) & kTimeBasedProfile) != 0) {
    Fail("its Drive Mode has the time-based profile; clear bit 2, e.g. with DYNAMIXEL Wizard");
  }
  limited_ = mode == kPosition;
  min_ticks_ = Get(table.min_position);
  max_ticks_ = Get(table.max_position);
}

std::string TurningMotor::WhyOutOfReach() const {
  using Limits = std::numeric_limits<std::int32_t>;
  const std::int64_t min = limited_ ? min_ticks_ : Limits::min();
  const std::int64_t max = limited_ ? max_ticks_ : Limits::max();
  for (const double angle : {device_.from_rad, device_.to_rad}) {
    const std::int64_t ticks = TicksAt(scanner_, angle);
    if (ticks >= min && ticks <= max) continue;
    const auto named = [&](std::int64_t at) {
      return Degrees(scanner_, at) + " deg (" + std::to_string(at) + " ticks)";
    };
    return "the rig's sweep goes to " + named(ticks) + ", the servo's own limits are " +
           named(min) + " and " + named(max) +
           "; change the rig's dynamixel from_deg and to_deg, or the servo's Min and Max Position "
           "Limit";
  }
  return "";
}

std::string TurningMotor::WhyPoorReadings() const {
  constexpr std::size_t kBytes = 14 + kStatusSize + 4;  // read, and answer with a position
  const double wire_us = kBytes * kBitsPerByte * 1e6 / device_.baud;
  if (wire_us > kMaxReadingUs) {
    return std::to_string(device_.baud) +
           " baud are too slow for 100 readings a second; set the servo and the rig to 57600 or "
           "more";
  }
  if (round_trips_.usual() > kMaxRoundTripUs) {
    return "answers take " + std::to_string(std::lround(round_trips_.usual())) +
           " us beside their time on the wire, and half of that is what the encoder's times may "
           "be wrong by; for a USB adapter, `echo 1 | sudo tee "
           "/sys/bus/usb-serial/devices/ttyUSB0/latency_timer` (with its name) mends it";
  }
  return "";
}

// The moments at which the request had left and at which the answer began. The bytes' time on the
// wire is added and taken off by the baud rate, since neither can be seen: a write returns when
// the kernel has the bytes, and a USB adapter hands on an answer's bytes all at once when the last
// has come. The clock is read before the write: were it read after, being interrupted just then
// would make the trip look shorter than it was, and nobody would notice.
std::optional<TurningMotor::Answer> TurningMotor::AskOnce(const Bytes& request,
                                                          std::size_t parameters) {
  const double us_per_byte = kBitsPerByte * 1e6 / device_.baud;
  const double request_us = static_cast<double>(request.size()) * us_per_byte;
  const double answer_us = static_cast<double>(kStatusSize + parameters) * us_per_byte;
  const std::int64_t bad_before = decoder_.bad_checksums();
  port_.Discard();
  decoder_.Clear();
  std::optional<Answer> answer;
  const double written_us = SteadyUs();
  const double give_up_us = written_us + request_us + answer_us + kAnswerUs;
  port_.Write(request);
  for (double now_us = written_us; !answer && now_us < give_up_us; now_us = SteadyUs()) {
    decoder_.Add(port_.Read(static_cast<std::int64_t>(give_up_us - now_us)));
    const double came_us = SteadyUs();
    while (auto status = decoder_.Next()) {
      if (status->id != device_.id) continue;
      if (status->ErrorNumber() == 0 && status->parameters.size() != parameters) continue;
      const double began_us = came_us - static_cast<double>(status->wire_size) * us_per_byte;
      answer = Answer{std::move(*status), written_us + request_us, began_us};
    }
    if (decoder_.bad_checksums() != bad_before) break;
  }
  const std::int64_t bad = decoder_.bad_checksums() - bad_before;
  counters_->bad_checksums += bad;
  missing_ = answer ? 0 : missing_ + 1;
  if (!answer && bad == 0) {
    ++counters_->timeouts;
    WaitForQuiet();
  }
  return answer;
}

// An answer that comes late must not answer the next request, and then each the one before it.
void TurningMotor::WaitForQuiet() {
  constexpr int kMaxReads = 100;
  for (int i = 0; i < kMaxReads && !port_.Read(kQuietUs).empty(); ++i) {
  }
}

void TurningMotor::CheckMissing() const {
  if (missing_ < kMaxMissing) return;
  Fail(std::to_string(missing_) + " answers in a row were missing or damaged at " +
       std::to_string(device_.baud) +
       " baud; check its power, its cable, and its id, baud rate and Status Return Level (2) "
       "against the rig");
}

dynamixel::Status TurningMotor::Ask(const Bytes& request, std::size_t parameters) {
  for (;;) {
    if (auto answer = AskOnce(request, parameters)) return answer->status;
    CheckMissing();
  }
}

void TurningMotor::CheckStatus(const dynamixel::Status& status, const std::string& what) {
  if (status.alert()) FailOnAlert();
  if (status.ErrorNumber() != 0) {
    Fail("refuses " + what + ": " + dynamixel::ErrorInWords(status.ErrorNumber()));
  }
}

void TurningMotor::FailOnAlert() {
  const Entry entry = model_->table->hardware_error;
  const dynamixel::Status status =
      Ask(dynamixel::EncodeRead(device_.id, entry.address, entry.size), 1);
  const int bits = status.parameters.empty() ? 0 : status.parameters[0];
  Fail("has stopped itself, hardware error: " + dynamixel::HardwareErrorInWords(bits) +
       "; remove the cause, then switch its power off and on");
}

std::int64_t TurningMotor::Get(Entry entry) {
  const dynamixel::Status status =
      Ask(dynamixel::EncodeRead(device_.id, entry.address, entry.size), entry.size);
  CheckStatus(status, "to be read");
  return entry.size == 4 ? dynamixel::SignedFrom(status.parameters)
                         : dynamixel::UnsignedFrom(status.parameters);
}

void TurningMotor::Set(Entry entry, std::int64_t value, const std::string& what) {
  const Bytes bytes = dynamixel::ToBytes(value, entry.size);
  CheckStatus(Ask(dynamixel::EncodeWrite(device_.id, entry.address, bytes), 0), what);
}

std::optional<PositionReading> TurningMotor::Read() {
  const Entry entry = model_->table->present_position;
  const auto answer =
      AskOnce(dynamixel::EncodeRead(device_.id, entry.address, entry.size), entry.size);
  if (!answer) {
    CheckMissing();
    return std::nullopt;
  }
  CheckStatus(answer->status, "to be read");
  const double trip_us = answer->began_us - answer->left_us;
  const bool unusual = round_trips_.IsUnusual(trip_us);
  counters_->round_trip_us = std::llround(round_trips_.usual());
  const double middle_us = (answer->left_us + answer->began_us) / 2;
  const Timed reading{middle_us, trip_us, dynamixel::SignedFrom(answer->status.parameters)};
  if (!unusual) return Publish(reading);
  ++counters_->left_out;
  const double longer_us = trip_us - round_trips_.usual();
  if (longer_us < 0 || longer_us > kMaxLongerUs) return std::nullopt;
  if (!best_left_out_ || trip_us < best_left_out_->trip_us) best_left_out_ = reading;
  if (middle_us - newest_us_ < kMaxGapUs) return std::nullopt;
  return Publish(*best_left_out_);
}

PositionReading TurningMotor::Publish(const Timed& reading) {
  newest_us_ = reading.steady_us;
  best_left_out_.reset();
  ++counters_->readings;
  return {ToUtime(reading.steady_us), reading.ticks, std::llround(reading.steady_us)};
}

// The goal is set to where it stands before the torque comes: an old goal would make it jump.
void TurningMotor::Start() {
  const dynamixel::ControlTable& table = *model_->table;
  const double turns_per_minute =
      device_.speed_rad_s * std::abs(scanner_.ticks_per_rad) / model_->ticks_per_turn * 60;
  const double acceleration = turns_per_minute * 60 / kAccelerationSeconds;
  const auto units = [](double value, double unit) {
    return std::max<std::int64_t>(1, std::llround(value / unit));  // 0 would be: no limit
  };
  Set(table.acceleration, units(acceleration, model_->acceleration_unit), "the acceleration");
  Set(table.velocity, units(turns_per_minute, model_->velocity_unit),
      "the rig's dynamixel speed_deg_s");
  Set(table.goal_position, Get(table.present_position), "to stay where it is");
  Set(table.torque_enable, 1, "torque on");
}

void TurningMotor::MoveTo(std::int64_t ticks) {
  Set(model_->table->goal_position, ticks, "the goal of " + std::to_string(ticks) + " ticks");
}

void TurningMotor::TorqueOff() noexcept {
  if (model_ == nullptr) return;
  const Entry entry = model_->table->torque_enable;
  for (int i = 0; i < kTorqueOffTries; ++i) {
    try {
      const Bytes off = dynamixel::ToBytes(0, entry.size);
      if (AskOnce(dynamixel::EncodeWrite(device_.id, entry.address, off), 0)) return;
    } catch (const std::exception&) {  // the port has gone
      return;
    }
  }
}

}  // namespace rgbdt
