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

void ScipClock::AddTime(std::uint32_t time_ms, Utime arrival, Utime round_trip) {
  learning_ = true;
  fit_.Add(counter_.Unwrap(time_ms), arrival, round_trip / 2);
}

// Against the times asked for.
Utime ScipClock::DelayOf(std::int64_t ms, Utime arrival) const {
  return arrival - fit_.ToHost(static_cast<double>(ms)).value();
}

bool ScipClock::StillLearns(std::int64_t ms, Utime arrival) {
  if (learnt_from_.empty()) learn_until_ms_ = ms + kLearnMs;
  if (ms >= learn_until_ms_ || DelayOf(ms, arrival) < -Milliseconds().step_us) return false;
  learnt_from_.emplace_back(ms, arrival);
  return true;
}

// Takes the least delay of the scans so far. False: somebody set a clock meanwhile.
bool ScipClock::EndLearning() {
  learning_ = false;
  Utime least = learnt_from_.empty() ? scan_delay_us_ : std::numeric_limits<Utime>::max();
  for (const auto& [tick, came] : learnt_from_) least = std::min(least, DelayOf(tick, came));
  scan_delay_us_ = std::max<Utime>(least, 0);
  bool steady = true;
  for (const auto& [tick, came] : learnt_from_) steady &= fit_.Add(tick, came, scan_delay_us_);
  learnt_from_.clear();
  return steady;
}

ScipClock::ScanTime ScipClock::AddScan(std::uint32_t time_ms, Utime arrival) {
  ScanTime time;
  time.ms = counter_.Unwrap(time_ms);
  if (learning_ && !StillLearns(time.ms, arrival)) time.was_set = !EndLearning();
  if (!learning_) time.was_set |= !fit_.Add(time.ms, arrival, scan_delay_us_);
  time.utime = MiddleOfTick(fit_, time.ms);
  return time;
}

}  // namespace rgbdt
