#include "services/drivers/dynamixel/motor_sweep.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace rgbdt {
namespace {

using ::testing::HasSubstr;

constexpr Utime kPeriod = 5000;

TurnedScanner Scanner() {
  TurnedScanner scanner;
  scanner.ticks_per_rad = 1000;
  scanner.motor.emplace();
  scanner.motor->from_rad = -0.5;
  scanner.motor->to_rad = 0.5;
  scanner.motor->speed_rad_s = 0.5;
  return scanner;
}

// The wall clock at a moment of the steady one.
using WallClock = std::function<Utime(Utime steady)>;

// A motor that goes where it is told, until it stands; what its sweep's last step was.
MotorSweep::Step Sweep(const WallClock& wall, Utime stands_from = 1'000'000'000) {
  MotorSweep sweep(Scanner(), 1);
  double ticks = -400, goal = ticks;
  MotorSweep::Step step;
  for (Utime steady = 0; steady < 10 * kMicrosecondsPerSecond; steady += kPeriod) {
    const double way = 500 * ToSeconds(kPeriod);  // ticks
    if (steady < stands_from) ticks += std::clamp(goal - ticks, -way, way);
    step = sweep.Take({wall(steady), std::llround(ticks), steady});
    if (step.move_to) goal = static_cast<double>(*step.move_to);
    if (step.done || !step.failure.empty()) return step;
  }
  return step;
}

TEST(MotorSweep, AWallClockThatIsSetStopsNoMotor) {
  const Utime second = kMicrosecondsPerSecond;
  EXPECT_TRUE(Sweep([](Utime steady) { return steady; }).done);
  for (const Utime jump : {-3600 * second, -10 * second, -second, -second / 5, second / 5, second,
                           10 * second, 3600 * second}) {
    for (const Utime when : {second / 10, second, 2 * second}) {
      const auto step = Sweep([&](Utime t) { return t + (t < when ? 0 : jump); });
      EXPECT_TRUE(step.done) << jump << " " << when << step.failure;
    }
  }
}

TEST(MotorSweep, AMotorThatStandsIsToldWhateverTheWallClockSays) {
  for (const double rate : {0.0, 1.0, -1.0}) {
    const auto step =
        Sweep([&](Utime t) { return static_cast<Utime>(rate * static_cast<double>(t)); },
              kMicrosecondsPerSecond);
    EXPECT_FALSE(step.done);
    EXPECT_THAT(step.failure, HasSubstr("the motor stands at")) << rate;
  }
}

}  // namespace
}  // namespace rgbdt
