#include "services/drivers/hokuyo/scip_clock.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "tests/numbers.h"

namespace rgbdt {
namespace {

TEST(ScipClock, TimesAskedForTellHowLateScansAre) {
  ScipClock clock(5000);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> even(0, 1);
  const auto ms = [](double us) {
    return static_cast<std::uint32_t>(static_cast<std::int64_t>(us * (1 + 50e-6) / 1000) %
                                      (1 << 24));
  };
  double t = 1e9;
  for (int i = 0; i < 10; ++i, t += 500 + 2000 * even(random)) {
    const double there = 100 + 50 * even(random);
    const double back = 100 + 50 * even(random);
    clock.AddTime(ms(t), kJune2015 + std::llround(t + back), std::llround(there + back));
  }
  double worst = 0, mean = 0;
  int count = 0;
  for (; t < 1e9 + 200e6; t += 25'013) {
    const double late = 9000 + 1500 * even(random);  // of which the scan takes 5000
    const ScipClock::ScanTime time = clock.AddScan(ms(t), kJune2015 + std::llround(t + late));
    EXPECT_FALSE(time.was_set);
    const double error = static_cast<double>(time.utime - kJune2015) - t;
    worst = std::max(worst, std::abs(error));
    mean += error;
    ++count;
  }
  mean /= count;
  RecordProperty("worst_us", std::to_string(worst));
  RecordProperty("mean_us", std::to_string(mean));
  EXPECT_NEAR(static_cast<double>(clock.scan_delay_us()), 9000, 500);
  EXPECT_LT(std::abs(mean), 400);
  EXPECT_LT(worst, 1200);
}

// In the midst of the first scans, from which it learns how late they are, or after that.
TEST(ScipClock, AHostsClockThatIsSetIsToldOnceAndCostsNoTime) {
  constexpr double kSecond = 1e6;
  constexpr double kWait = 2 * kSecond;  // ClockFitOptions::step_wait_us, for one set forward
  for (const double when : {1 * kSecond, 20 * kSecond}) {
    for (const double jump : {-10.0, -1.0, -0.2, 0.2, 1.0, 10.0}) {
      ScipClock clock(5000);
      const auto host = [&](double t) {
        return kJune2015 + std::llround(t + (t < when ? 0 : jump * kSecond));
      };
      const auto ms = [](double t) { return static_cast<std::uint32_t>(t / 1000); };
      for (double t = 0; t < 20'000; t += 2000) clock.AddTime(ms(t), host(t + 125), 250);
      int told = 0;
      for (double t = 30'000; t < 40 * kSecond; t += 25'013) {
        const ScipClock::ScanTime time = clock.AddScan(ms(t), host(t + 9000));
        told += time.was_set ? 1 : 0;
        if (t > when && t < when + kWait + kSecond) continue;
        const double error = static_cast<double>(time.utime - host(t));
        EXPECT_LT(std::abs(error), 2000) << jump << " s at " << when << ", " << t << " us";
      }
      EXPECT_EQ(told, 1) << jump << " s at " << when;
      EXPECT_NEAR(static_cast<double>(clock.scan_delay_us()), 9000, 1000) << jump << " at " << when;
    }
  }
}

}  // namespace
}  // namespace rgbdt
