#include "services/drivers/hokuyo/scip_clock.h"

#include <algorithm>
#include <limits>

namespace rgbdt {
namespace {

ClockFitOptions Milliseconds() {
  ClockFitOptions options;
  options.tick_us = 1000;
  return options;
}

// A counter shows the tick that has passed: in the mean it was half a tick ago.
Utime MiddleOfTick(const ClockFit& fit, std::int64_t ms) {
  return fit.ToHost(static_cast<double>(ms) + 0.5).value();
}

}  // namespace

ScipClock::ScipClock(Utime scan_us)
    : counter_(1 << 24), fit_(Milliseconds()), scan_delay_us_(scan_us) {}

void ScipClock::AddTime(std::uint32_t time_ms, Utime sent, Utime arrival) {
  learning_ = true;
  fit_.Add(counter_.Unwrap(time_ms), arrival, (arrival - sent) / 2);
}

// The least delay of the scans so far against the times asked for; true once it is known.
bool ScipClock::Learn(std::int64_t ms, Utime arrival) {
  if (learnt_from_.empty()) learn_until_ = arrival + kLearn_us;
  learnt_from_.emplace_back(ms, arrival);
  if (arrival < learn_until_) return false;
  Utime least = std::numeric_limits<Utime>::max();
  for (const auto& [tick, came] : learnt_from_) {
    least = std::min(least, came - fit_.ToHost(static_cast<double>(tick)).value());
  }
  scan_delay_us_ = std::max<Utime>(least, 0);
  return true;
}

ScipClock::ScanTime ScipClock::AddScan(std::uint32_t time_ms, Utime arrival) {
  ScanTime time;
  time.ms = counter_.Unwrap(time_ms);
  if (!learning_) {
    time.was_set = !fit_.Add(time.ms, arrival, scan_delay_us_);
  } else if (Learn(time.ms, arrival)) {
    for (const auto& [tick, came] : learnt_from_) fit_.Add(tick, came, scan_delay_us_);
    learnt_from_.clear();
    learning_ = false;
  }
  time.utime = MiddleOfTick(fit_, time.ms);
  return time;
}

}  // namespace rgbdt
