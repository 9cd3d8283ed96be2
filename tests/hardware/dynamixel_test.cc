#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <thread>

#include "services/drivers/dynamixel/motor_node.h"
#include "services/drivers/dynamixel/serial_port.h"
#include "services/messages/status_counters.h"
#include "tests/hardware/device_harness.h"
#include "tests/hardware/dynamixel_peer.h"
#include "tests/numbers.h"

namespace rgbdt {
namespace {

using test::DynamixelPeer;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kTicksPerDegree = 501923 / 360.0;

// Where the peer's port is, a sweep of 60 degrees at 90 degrees a second.
TurnedScanner ScannerOn(const DynamixelPeer& peer) {
  TurnedScanner scanner;
  scanner.ticks_per_rad = kTicksPerDegree / kDegree;
  scanner.zero_ticks = 1000;
  scanner.motor = DynamixelDevice{};
  scanner.motor->port = peer.port();
  scanner.motor->baud = 1'000'000;
  scanner.motor->from_rad = -30 * kDegree;
  scanner.motor->to_rad = 30 * kDegree;
  scanner.motor->speed_rad_s = 90 * kDegree;
  return scanner;
}

double TicksAtDegree(double degree) { return 1000 + degree * kTicksPerDegree; }

SessionCommand SweepCommand(std::int64_t number) {
  SessionCommand command;
  command.command = number;
  command.verb = SessionVerb::kSweep;
  return command;
}

bool Within(double seconds, const std::function<bool()>& holds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!holds()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

// What a node said, and waiting for it to say something.
class Listener {
 public:
  explicit Listener(const TurnedScanner& scanner) {
    LidarSpec lidar;
    lidar.turned_scanner = scanner;
    node_ = std::make_unique<MotorNode>(lidar);
  }

  MotorNode& node() { return *node_; }
  void Destroy() { node_.reset(); }
  void Send(const SessionCommand& command) { Keep(node_->Handle(command)); }

  bool WaitReady() {
    return WaitFor([this] { return node_->GetStatus().ready; });
  }
  bool WaitFor(const std::function<bool()>& holds) {
    return Within(20, [&] {
      DeviceOutput output = OutputOf(node_.get());
      Keep(std::move(output.messages));
      for (const std::string& warning : output.warnings) warnings_ += warning + "\n";
      return holds();
    });
  }
  /// The event that ends a command; kProgress where none came.
  SessionEvent WaitForEnd(std::int64_t command) {
    const auto ends = [&](const SessionEvent& e) {
      return e.command == command && e.kind != EventKind::kProgress;
    };
    WaitFor([&] { return std::any_of(events_.begin(), events_.end(), ends); });
    const auto found = std::find_if(events_.begin(), events_.end(), ends);
    if (found != events_.end()) return *found;
    SessionEvent none;
    none.kind = EventKind::kProgress;
    return none;
  }
  bool WaitForReadings(std::size_t count) {
    const std::size_t wanted = readings_.size() + count;
    return WaitFor([&] { return readings_.size() >= wanted; });
  }
  std::int64_t Counter(const std::string& name) const {
    return CounterOf(node_->GetStatus(), name, -1);
  }

  const std::vector<EncoderReading>& readings() const { return readings_; }
  const std::vector<SessionEvent>& events() const { return events_; }
  const std::string& warnings() const { return warnings_; }
  std::vector<EncoderReading> OfSweep(Utime sweep_utime) const {
    std::vector<EncoderReading> found;
    for (const EncoderReading& reading : readings_) {
      if (reading.sweep_utime == sweep_utime) found.push_back(reading);
    }
    return found;
  }

 private:
  void Keep(Messages messages) {
    for (Message& message : messages) {
      if (const auto* reading = std::get_if<EncoderReading>(&message)) {
        readings_.push_back(*reading);
      } else if (auto* event = std::get_if<SessionEvent>(&message)) {
        events_.push_back(std::move(*event));
      }
    }
  }

  std::unique_ptr<MotorNode> node_;
  std::vector<EncoderReading> readings_;
  std::vector<SessionEvent> events_;
  std::string warnings_;
};

// By how much each stamp is off [us]: how long before or after it the servo really was there.
std::vector<double> StampErrors(const std::vector<EncoderReading>& readings,
                                const DynamixelPeer& peer) {
  std::vector<double> errors;
  for (const EncoderReading& reading : readings) {
    const auto utime = static_cast<double>(reading.utime);
    const double speed = peer.TrueSpeedAt(utime);
    if (std::abs(speed) < 20 * kTicksPerDegree) continue;
    const double ticks = static_cast<double>(reading.ticks) - peer.TrueTicksAt(utime);
    errors.push_back(std::abs(ticks / speed) * 1e6);
  }
  std::sort(errors.begin(), errors.end());
  return errors;
}

// Times between readings [us], the smallest first.
std::vector<double> Gaps(const std::vector<EncoderReading>& readings) {
  std::vector<double> gaps;
  for (std::size_t i = 1; i < readings.size(); ++i) {
    gaps.push_back(static_cast<double>(readings[i].utime - readings[i - 1].utime));
  }
  std::sort(gaps.begin(), gaps.end());
  return gaps;
}

double Quantile(const std::vector<double>& sorted, double share) {
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

// A time is known to half of its round trip. On a machine that is too busy to serve a
// pseudo-terminal those are long, which the node says itself; otherwise 0.2 ms are required.
double StampBound(const Listener& motor) {
  return std::max(200.0, 0.75 * static_cast<double>(motor.Counter("round trip us")));
}

void PrintStamps(const std::vector<EncoderReading>& sweep, const std::vector<double>& errors,
                 const Listener& motor) {
  const double seconds = ToSeconds(sweep.back().utime - sweep.front().utime);
  std::printf(
      "readings/s %.0f, stamps off by median %.0f us, 95%% %.0f us, max %.0f us; "
      "largest gap %.1f ms, left out %d beside %d\n",
      static_cast<double>(sweep.size()) / seconds, Quantile(errors, 0.5), Quantile(errors, 0.95),
      errors.back(), Gaps(sweep).back() / 1e3, static_cast<int>(motor.Counter("left out")),
      static_cast<int>(motor.Counter("readings")));
}

class DynamixelSweep : public ::testing::TestWithParam<int> {};

TEST_P(DynamixelSweep, ReadsOftenWithTheServosOwnTimes) {
  DynamixelPeer::Options options;
  options.position = TicksAtDegree(-29);
  DynamixelPeer peer(options);
  TurnedScanner scanner = ScannerOn(peer);
  scanner.motor->baud = GetParam();
  scanner.motor->speed_rad_s = 45 * kDegree;
  Listener motor(scanner);
  ASSERT_TRUE(motor.WaitReady());
  ASSERT_TRUE(motor.WaitForReadings(10));
  EXPECT_EQ(motor.readings().back().sweep_utime, 0);
  EXPECT_EQ(peer.state().return_delay, 0);
  EXPECT_FALSE(peer.state().torque);
  motor.Send(SweepCommand(7));
  const SessionEvent done = motor.WaitForEnd(7);
  ASSERT_EQ(done.kind, EventKind::kDone) << done.text;
  EXPECT_EQ(done.source, "motor");
  ASSERT_TRUE(motor.WaitForReadings(10));
  EXPECT_EQ(motor.readings().back().sweep_utime, 0);

  const std::vector<EncoderReading> sweep = motor.OfSweep(done.sweep_utime);
  ASSERT_GT(sweep.size(), 1u);
  EXPECT_EQ(sweep.front().utime, done.sweep_utime);
  EXPECT_NEAR(static_cast<double>(sweep.front().ticks), TicksAtDegree(-30), kTicksPerDegree / 2);
  // No longer named is the first reading at the other end.
  const auto after = std::find_if(
      motor.readings().begin(), motor.readings().end(),
      [&](const EncoderReading& reading) { return reading.utime > sweep.back().utime; });
  ASSERT_NE(after, motor.readings().end());
  EXPECT_NEAR(static_cast<double>(after->ticks), TicksAtDegree(30), kTicksPerDegree / 2);
  const double seconds = ToSeconds(sweep.back().utime - sweep.front().utime);
  const std::vector<double> errors = StampErrors(sweep, peer);
  ASSERT_FALSE(errors.empty());
  PrintStamps(sweep, errors, motor);
  EXPECT_LT(Quantile(errors, 0.5), StampBound(motor));
  // The node leaves out what came late. On a machine so busy that this is much there are fewer
  // readings than asked for, and more that were taken since there was no better one.
  if (motor.Counter("left out") * 5 < motor.Counter("readings")) {
    EXPECT_GE(static_cast<double>(sweep.size()) / seconds, 100);
    EXPECT_LT(Quantile(Gaps(motor.readings()), 0.95), 1e5);
    EXPECT_LT(Quantile(errors, 0.95), StampBound(motor));
  }
  EXPECT_EQ(motor.Counter("sweeps"), 1);
  EXPECT_THAT(motor.warnings(), Not(HasSubstr("servo")));
  motor.Destroy();
  EXPECT_FALSE(peer.state().torque);
}

INSTANTIATE_TEST_SUITE_P(Baud, DynamixelSweep, ::testing::Values(57600, 1'000'000, 3'000'000));

TEST(DynamixelMotor, GoesToTheNearerEndAndBackWithTheNextSweep) {
  DynamixelPeer::Options options;
  options.position = TicksAtDegree(10);
  DynamixelPeer peer(options);
  Listener motor(ScannerOn(peer));
  ASSERT_TRUE(motor.WaitReady());
  motor.Send(SweepCommand(1));
  const SessionEvent first = motor.WaitForEnd(1);
  ASSERT_EQ(first.kind, EventKind::kDone) << first.text;
  motor.Send(SweepCommand(2));
  const SessionEvent second = motor.WaitForEnd(2);
  ASSERT_EQ(second.kind, EventKind::kDone) << second.text;
  const auto there = motor.OfSweep(first.sweep_utime), back = motor.OfSweep(second.sweep_utime);
  EXPECT_NEAR(static_cast<double>(there.front().ticks), TicksAtDegree(30), kTicksPerDegree);
  EXPECT_NEAR(static_cast<double>(back.front().ticks), TicksAtDegree(-30), kTicksPerDegree);
  // Progress: some, and at most four a second by the machine's steady clock. The stamps are of the
  // wall clock, which NTP may slew by 500 ppm and which is read some microseconds beside the other.
  constexpr Utime kLeast = 250'000 - 125 - 75;
  Utime before = 0;
  int progress = 0;
  for (const SessionEvent& event : motor.events()) {
    if (event.kind != EventKind::kProgress || event.command != 1) continue;
    if (progress++ > 0) {
      EXPECT_GE(event.utime - before, kLeast);
    }
    before = event.utime;
  }
  EXPECT_GE(progress, 2);
}

TEST(DynamixelMotor, RefusesASweepDuringASweep) {
  DynamixelPeer peer({});
  Listener motor(ScannerOn(peer));
  ASSERT_TRUE(motor.WaitReady());
  motor.Send(SweepCommand(1));
  motor.Send(SweepCommand(2));
  const SessionEvent refused = motor.WaitForEnd(2);
  EXPECT_EQ(refused.kind, EventKind::kFailed);
  EXPECT_THAT(refused.text, HasSubstr("busy"));
  EXPECT_EQ(motor.WaitForEnd(1).kind, EventKind::kDone);
}

// As one that was killed in the midst of a sweep and started anew.
TEST(DynamixelMotor, AnotherSessionsSweepFollowsTheOneUnderWay) {
  DynamixelPeer peer({});
  Listener motor(ScannerOn(peer));
  ASSERT_TRUE(motor.WaitReady());
  constexpr std::int64_t kOther = (std::int64_t{7} << 32) + 1;
  motor.Send(SweepCommand(1));
  motor.Send(SweepCommand(kOther));
  EXPECT_EQ(motor.WaitForEnd(1).kind, EventKind::kDone);
  EXPECT_EQ(motor.WaitForEnd(kOther).kind, EventKind::kDone);
}

TEST(DynamixelMotor, SwitchesTheTorqueOffWhenItEndsWithinASweep) {
  DynamixelPeer peer({});
  Listener motor(ScannerOn(peer));
  ASSERT_TRUE(motor.WaitReady());
  motor.Send(SweepCommand(1));
  ASSERT_TRUE(motor.WaitFor(
      [&] { return !motor.readings().empty() && motor.readings().back().sweep_utime != 0; }));
  EXPECT_TRUE(peer.state().torque);
  motor.Destroy();
  EXPECT_FALSE(peer.state().torque);
}

TEST(DynamixelMotor, FailsWhereTheMotorStandsAndSweepsAgainWhenItIsFree) {
  DynamixelPeer::Options options;
  options.position = TicksAtDegree(-30);
  DynamixelPeer peer(options);
  Listener motor(ScannerOn(peer));
  ASSERT_TRUE(motor.WaitReady());
  DynamixelPeer::Faults faults;
  faults.stall_at = TicksAtDegree(5);
  peer.SetFaults(faults);
  motor.Send(SweepCommand(1));
  const SessionEvent failed = motor.WaitForEnd(1);
  EXPECT_EQ(failed.kind, EventKind::kFailed);
  EXPECT_THAT(failed.text, HasSubstr("the motor stands at 5.0 deg"));
  EXPECT_FALSE(peer.state().torque);
  peer.SetFaults({});
  motor.Send(SweepCommand(2));
  EXPECT_EQ(motor.WaitForEnd(2).kind, EventKind::kDone);
}

TEST(DynamixelMotor, FailsWithAServoThatFallsSilentAndFindsItAgain) {
  DynamixelPeer peer({});
  Listener motor(ScannerOn(peer));
  ASSERT_TRUE(motor.WaitReady());
  motor.Send(SweepCommand(1));
  ASSERT_TRUE(motor.WaitForReadings(5));
  DynamixelPeer::Faults faults;
  faults.silent = true;
  peer.SetFaults(faults);
  const SessionEvent failed = motor.WaitForEnd(1);
  EXPECT_EQ(failed.kind, EventKind::kFailed);
  EXPECT_THAT(failed.text, HasSubstr("answers in a row were missing"));
  EXPECT_GE(motor.Counter("time-outs"), TurningMotor::kMaxMissing);
  EXPECT_FALSE(motor.node().GetStatus().ready);
  motor.Send(SweepCommand(2));
  EXPECT_EQ(motor.WaitForEnd(2).kind, EventKind::kFailed);  // at once: nobody is there
  peer.SetFaults({});
  ASSERT_TRUE(motor.WaitReady());
  EXPECT_FALSE(peer.state().torque);
  motor.Send(SweepCommand(3));
  EXPECT_EQ(motor.WaitForEnd(3).kind, EventKind::kDone);
  EXPECT_THAT(motor.warnings(), HasSubstr("baud rate"));
}

TEST(DynamixelMotor, FailsWithTheServosHardwareError) {
  DynamixelPeer peer({});
  Listener motor(ScannerOn(peer));
  ASSERT_TRUE(motor.WaitReady());
  motor.Send(SweepCommand(1));
  ASSERT_TRUE(motor.WaitForReadings(5));
  DynamixelPeer::Faults faults;
  faults.hardware_error = 0x20;
  peer.SetFaults(faults);
  const SessionEvent failed = motor.WaitForEnd(1);
  EXPECT_EQ(failed.kind, EventKind::kFailed);
  EXPECT_THAT(failed.text, HasSubstr("hardware error: overload"));
}

TEST(DynamixelMotor, SweepsInSpiteOfDamagedAnswersAndNoise) {
  DynamixelPeer peer({});
  Listener motor(ScannerOn(peer));
  ASSERT_TRUE(motor.WaitReady());
  DynamixelPeer::Faults faults;
  faults.bad_checksum_every = 4;
  faults.noise_bytes = 5;
  peer.SetFaults(faults);
  motor.Send(SweepCommand(1));
  const SessionEvent done = motor.WaitForEnd(1);
  ASSERT_EQ(done.kind, EventKind::kDone) << done.text;
  EXPECT_GT(motor.Counter("bad checksums"), 10);
  const std::vector<double> errors = StampErrors(motor.OfSweep(done.sweep_utime), peer);
  ASSERT_FALSE(errors.empty());
  EXPECT_LT(Quantile(errors, 0.5), StampBound(motor));
}

TEST(DynamixelMotor, RefusesASweepBeyondTheServosLimitsBeforeAnythingMoves) {
  DynamixelPeer::Options options;
  options.max_position = std::llround(TicksAtDegree(20));
  DynamixelPeer peer(options);
  Listener motor(ScannerOn(peer));
  ASSERT_TRUE(motor.WaitReady());
  motor.Send(SweepCommand(1));
  const SessionEvent refused = motor.WaitForEnd(1);
  EXPECT_EQ(refused.kind, EventKind::kFailed);
  EXPECT_THAT(refused.text, HasSubstr("goes to 30.0 deg"));
  EXPECT_THAT(refused.text, HasSubstr("20.0 deg"));
  EXPECT_EQ(peer.state().moves, 0);
  EXPECT_FALSE(peer.state().torque);
  ASSERT_TRUE(motor.WaitForReadings(5));  // where it stands is told nevertheless
  EXPECT_THAT(motor.warnings(), HasSubstr("limits"));
}

TEST(DynamixelMotor, ManyTurnsHaveNoLimits) {
  DynamixelPeer::Options options;
  options.operating_mode = 4;
  DynamixelPeer peer(options);
  TurnedScanner scanner = ScannerOn(peer);
  scanner.motor->to_rad = 400 * kDegree;
  MotorCounters counters;
  EXPECT_EQ(TurningMotor(scanner, &counters).WhyOutOfReach(), "");
}

TEST(DynamixelMotor, ServesAServoThatIsUnpluggedAndPluggedIn) {
  const auto link = std::filesystem::path(testing::TempDir()) /
                    ("servo_" + std::to_string(static_cast<int>(getpid())));
  DynamixelPeer::Options options;
  options.link = link;
  DynamixelPeer peer(options);
  Listener motor(ScannerOn(peer));
  ASSERT_TRUE(motor.WaitReady());
  motor.Send(SweepCommand(1));
  ASSERT_TRUE(motor.WaitForReadings(5));
  peer.Unplug();
  const SessionEvent failed = motor.WaitForEnd(1);
  EXPECT_EQ(failed.kind, EventKind::kFailed);
  EXPECT_THAT(failed.text, HasSubstr("is it plugged in?"));
  ASSERT_TRUE(motor.WaitFor([&] { return !motor.node().GetStatus().ready; }));
  peer.PlugIn();
  ASSERT_TRUE(motor.WaitReady());
  EXPECT_FALSE(peer.state().torque);
  motor.Send(SweepCommand(2));
  EXPECT_EQ(motor.WaitForEnd(2).kind, EventKind::kDone);
}

std::string ErrorOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const DeviceError& e) {
    return e.what();
  }
  return "";
}

std::string ErrorWith(const DynamixelPeer::Options& options) {
  DynamixelPeer peer(options);
  MotorCounters counters;
  return ErrorOf([&] { TurningMotor motor(ScannerOn(peer), &counters); });
}

TEST(DynamixelMotor, SaysWhatIsWrongWithAServo) {
  DynamixelPeer::Options options;
  options.model = 350;
  EXPECT_THAT(ErrorWith(options), HasSubstr("model number 350 is not known"));
  options = {};
  options.operating_mode = 1;
  EXPECT_THAT(ErrorWith(options), HasSubstr("Operating Mode is 1"));
  options = {};
  options.id = 2;
  EXPECT_THAT(ErrorWith(options), HasSubstr("check its power"));
}

TEST(SerialPort, SaysWhatIsWrongWithAPort) {
  EXPECT_THAT(ErrorOf([] { SerialPort("/dev/there_is_none", 57600); }), HasSubstr("plugged in"));
  EXPECT_THAT(ErrorOf([] { SerialPort("/dev/null", 57600); }), HasSubstr("not a serial port"));
  DynamixelPeer peer({});
  const std::string port = peer.port();
  {
    SerialPort first(port, 57600);
    EXPECT_THAT(ErrorOf([&] { SerialPort(port, 57600); }), HasSubstr("another program has it"));
  }
  EXPECT_EQ(ErrorOf([&] { SerialPort(port, 4'000'000); }), "");
}

}  // namespace
}  // namespace rgbdt
