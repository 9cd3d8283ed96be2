#include "services/drivers/clock_fit.h"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "calib/model/errors.h"
#include "tests/numbers.h"

namespace rgbdt {
namespace {

using ::testing::HasSubstr;

// A device that is read every `period_us` of true time; its clock runs `drift` fast.
struct Device {
  double period_us = 25'000;
  double drift = 50e-6;
  double constant_us = 0;   // least delay
  double jitter_us = 1000;  // mean of the exponential one on top
  double tick_us = 1;
  std::int64_t first_ticks = 123'456;

  std::int64_t Ticks(double true_us) const {
    return first_ticks + static_cast<std::int64_t>(std::floor(true_us * (1 + drift) / tick_us));
  }
};

struct Errors {
  double worst_us = 0, rms_us = 0;
};

// Errors of the fit for the newest reading, from `after_s` on.
Errors Follow(const Device& device, unsigned seed, double seconds, double after_s,
              const ClockFitOptions& options) {
  ClockFit fit(options);
  std::mt19937 random(seed);
  std::exponential_distribution<double> jitter(1 / device.jitter_us);
  Errors errors;
  int count = 0;
  for (double t = 0; t < seconds * 1e6; t += device.period_us) {
    const std::int64_t ticks = device.Ticks(t);
    const double delay = device.constant_us + jitter(random);
    EXPECT_TRUE(fit.Add(ticks, kJune2015 + std::llround(t + delay)));
    if (t < after_s * 1e6) continue;
    // Half a tick: a counter shows the tick that has passed.
    const Utime host =
        fit.ToHost(static_cast<double>(ticks) + (device.tick_us > 1 ? 0.5 : 0)).value();
    const double error = static_cast<double>(host - kJune2015) - t;
    errors.worst_us = std::max(errors.worst_us, std::abs(error));
    errors.rms_us += error * error;
    ++count;
  }
  errors.rms_us = std::sqrt(errors.rms_us / count);
  return errors;
}

TEST(ClockFit, ErrorIsFarBelowTheJitter) {
  ClockFitOptions options;
  options.min_delay_us = 3000;
  Device device;
  device.constant_us = 3000;
  double worst = 0, rms = 0, worst_early = 0;
  constexpr int kRuns = 50;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const Errors errors = Follow(device, seed, 120, 20, options);
    worst = std::max(worst, errors.worst_us);
    rms += errors.rms_us / kRuns;
    worst_early = std::max(worst_early, Follow(device, seed, 20, 1, options).worst_us);
  }
  RecordProperty("worst_us", std::to_string(worst));
  RecordProperty("rms_us", std::to_string(rms));
  RecordProperty("worst_early_us", std::to_string(worst_early));
  EXPECT_LT(rms, 40);
  EXPECT_LT(worst, 250);
  EXPECT_LT(worst_early, 1000);
}

TEST(ClockFit, AMillisecondCounterIsGoodToItsTick) {
  Device device;
  device.tick_us = 1000;
  device.period_us = 25'013;  // no whole ticks, as of a motor: else the ticks' phase creeps
  device.jitter_us = 500;
  ClockFitOptions options;
  options.tick_us = 1000;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Errors errors = Follow(device, seed, 90, 20, options);
    EXPECT_LT(errors.rms_us, 400) << seed;  // of a tick alone: 289
    EXPECT_LT(errors.worst_us, 800) << seed;
  }
}

TEST(ClockFit, FindsTheRateAndKeepsToItsBound) {
  for (const double drift : {-200e-6, -50e-6, 0.0, 50e-6, 200e-6, 900e-6}) {
    Device device;
    device.drift = drift;
    ClockFit fit;
    std::mt19937 random(7);
    std::exponential_distribution<double> jitter(1e-3);
    for (double t = 0; t < 60e6; t += 25'000) {
      fit.Add(device.Ticks(t), kJune2015 + std::llround(t + jitter(random)));
    }
    EXPECT_NEAR(fit.rate(), std::max(-drift, -500e-6), 5e-6);
  }
}

TEST(ClockFit, BeforeTheBaseTheLeastDelayWithRateOne) {
  ClockFit fit;
  EXPECT_FALSE(fit.ToHost(0));
  fit.Add(1000, kJune2015 + 700);
  EXPECT_EQ(fit.ToHost(1000), kJune2015 + 700);
  fit.Add(101'000, kJune2015 + 100'200);
  EXPECT_EQ(fit.ToHost(1000), kJune2015 + 200);
  EXPECT_EQ(fit.rate(), 0);
  fit.Add(201'000, kJune2015 + 200'900);
  EXPECT_EQ(fit.ToHost(201'000), kJune2015 + 200'200);
}

TEST(ClockFit, AClockThatIsSetStartsAnewAndSaysSo) {
  // Either clock, either way: what is added to the device's clock, and to the host's [s].
  for (const auto& [device_s, host_s] :
       {std::pair(3.0, 0.0), std::pair(-3.0, 0.0), std::pair(-1e5, 0.0), std::pair(0.0, 3600.0),
        std::pair(0.0, -3600.0), std::pair(0.0, 0.2), std::pair(0.0, -0.2)}) {
    ClockFit fit;
    int restarts = 0;
    Utime host = 0;
    Utime mapped = 0;
    for (int i = 0; i < 40 * 20; ++i) {
      const bool set = i >= 400;
      const std::int64_t ticks =
          200'000'000'000 + i * 25'000LL + (set ? static_cast<std::int64_t>(device_s * 1e6) : 0);
      host = kJune2015 + i * 25'000LL + (set ? static_cast<Utime>(host_s * 1e6) : 0);
      if (!fit.Add(ticks, host + 300 + i * 37 % 200)) ++restarts;
      mapped = fit.ToHost(static_cast<double>(ticks)).value();
    }
    EXPECT_EQ(restarts, 1) << device_s << " " << host_s;
    EXPECT_NEAR(static_cast<double>(mapped - host), 300, 50) << device_s << " " << host_s;
  }
}

TEST(ClockFit, AStallIsNoStep) {
  ClockFit fit;
  for (int i = 0; i < 4000; ++i) {
    const Utime delay = i >= 1000 && i < 1060 ? (1060 - i) * 25'000 : 0;  // 1.5 s pile up
    EXPECT_TRUE(fit.Add(i * 25'000LL, kJune2015 + i * 25'000LL + delay));
    EXPECT_NEAR(static_cast<double>(*fit.ToHost(i * 25e3) - kJune2015 - i * 25'000LL), 0, 5);
  }
  EXPECT_LE(fit.size(), 601u);
}

TEST(ClockFit, ReadingsOutOfOrderAndTwiceAreTaken) {
  ClockFit fit;
  for (const int i : {0, 2, 1, 3, 3, 2, 400, 399, 400}) {
    EXPECT_TRUE(fit.Add(i * 25'000LL, kJune2015 + i * 25'000LL + 10));
  }
  EXPECT_NEAR(static_cast<double>(*fit.ToHost(1e7) - kJune2015), 1e7 + 10, 1);
}

TEST(ClockFit, BadOptionsAreNamed) {
  ClockFitOptions options;
  options.base_s = 100;
  try {
    ClockFit fit(options);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("base_s is 100"));
  }
}

TEST(CounterUnwrapper, GoesOnWhereTheCounterWraps) {
  CounterUnwrapper counter(1 << 24);
  EXPECT_EQ(counter.Unwrap((1 << 24) - 2), (1 << 24) - 2);
  EXPECT_EQ(counter.Unwrap(1), (1 << 24) + 1);
  EXPECT_EQ(counter.Unwrap((1 << 24) - 1), (1 << 24) - 1);  // a late one
  EXPECT_EQ(counter.Unwrap(5), (1 << 24) + 5);
}

TEST(PtpToUtc, TakesWholeSecondsAway) {
  EXPECT_EQ(PtpToUtc(kJune2015 + 37'000'000, kJune2015 + 900), kJune2015) << "TAI";
  EXPECT_EQ(PtpToUtc(kJune2015, kJune2015 + 900), kJune2015) << "UTC";
  EXPECT_EQ(PtpToUtc(kJune2015 + 37'000'000, kJune2015 + 150'000), kJune2015) << "a late arrival";
}

TEST(PtpToUtc, AClockOfItsOwnIsNotBelieved) {
  EXPECT_FALSE(PtpToUtc(5'000'000, kJune2015));
  EXPECT_FALSE(PtpToUtc(kJune2015 + 500'000, kJune2015));
}

}  // namespace
}  // namespace rgbdt
