#include "services/drivers/clock_fit.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "calib/model/check.h"
#include "calib/model/errors.h"

namespace rgbdt {
std::optional<Utime> PtpToUtc(Utime stamp, Utime arrival) {
  constexpr Utime kMostApart = 60 * kMicrosecondsPerSecond;
  constexpr Utime kMostOff = kMicrosecondsPerSecond / 5;
  const Utime ahead = stamp - arrival;
  if (std::abs(ahead) > kMostApart) return std::nullopt;
  const auto whole = static_cast<Utime>(std::llround(ToSeconds(ahead))) * kMicrosecondsPerSecond;
  if (std::abs(ahead - whole) > kMostOff) return std::nullopt;
  return stamp - whole;
}

std::int64_t CounterUnwrapper::Unwrap(std::int64_t reading) {
  if (last_) {
    const std::int64_t ahead = ((reading - *last_) % period_ + period_) % period_;
    last_ = *last_ + (ahead <= period_ / 2 ? ahead : ahead - period_);
  } else {
    last_ = reading;
  }
  return *last_;
}

void ClockFitOptions::Check() const {
  const OptionCheck check("clock fit");
  check.Require(tick_us > 0, "tick_us", tick_us, "a number above 0");
  check.Require(window_s > 0, "window_s", window_s, "a number above 0");
  check.Require(max_points >= 2, "max_points", max_points, "2 or more");
  check.Require(base_s > 0 && base_s <= window_s, "base_s", base_s, "above 0, up to window_s");
  check.Require(max_rate >= 0 && max_rate < 0.1, "max_rate", max_rate, "0 to 0.1");
  check.Require(step_us > 0, "step_us", static_cast<double>(step_us), "a number above 0");
  check.Require(step_wait_us > 0, "step_wait_us", static_cast<double>(step_wait_us),
                "a number above 0");
}

ClockFit::ClockFit(const ClockFitOptions& options) : options_(options) { options.Check(); }

void ClockFit::Begin(std::int64_t ticks, Utime arrival) {
  points_.clear();
  first_ticks_ = ticks;
  first_arrival_ = arrival;
  slope_ = 0;
  offset_ = 0;
  behind_since_.reset();
  empty_ = false;
}

ClockFit::Point ClockFit::PointOf(std::int64_t ticks, Utime arrival) const {
  Point point;
  point.x = static_cast<double>(ticks - first_ticks_) * options_.tick_us;
  point.y = static_cast<double>(arrival - first_arrival_) - point.x;
  const double stretch_us = options_.window_s * 1e6 / options_.max_points;
  point.stretch = static_cast<std::int64_t>(std::floor(point.x / stretch_us));
  return point;
}

bool ClockFit::Add(std::int64_t ticks, Utime arrival, Utime min_delay_us) {
  arrival -= min_delay_us + options_.min_delay_us;
  bool anew = empty_;
  if (!empty_) anew = Stepped(PointOf(ticks, arrival), arrival);
  const bool stepped = anew && !empty_;
  if (anew) Begin(ticks, arrival);
  Keep(PointOf(ticks, arrival));
  return !stepped;
}

// Nothing arrives before it was sent, so a reading well before the fit means that a clock was set.
// One behind it may just be late, but not all of them for seconds.
bool ClockFit::Stepped(const Point& point, Utime arrival) {
  const double delay = point.y - (offset_ + slope_ * point.x);
  const auto step = static_cast<double>(options_.step_us);
  if (delay < -step || point.x < points_.front().x - step) return true;
  if (delay <= step) {
    behind_since_.reset();
    return false;
  }
  if (!behind_since_) behind_since_ = arrival;
  return arrival - *behind_since_ >= options_.step_wait_us;
}

// Of each stretch of the window only the reading least delayed can touch the hull.
void ClockFit::Keep(const Point& point) {
  auto place = points_.end();
  while (place != points_.begin() && std::prev(place)->stretch >= point.stretch) --place;
  if (place == points_.end() || place->stretch != point.stretch) {
    points_.insert(place, point);
  } else if (point.y < place->y) {
    *place = point;
  } else {
    return;
  }
  const double oldest = points_.back().x - options_.window_s * 1e6;
  while (points_.front().x < oldest) points_.pop_front();
  Fit();
}

void ClockFit::FitWithSlope(double slope) {
  slope_ = slope;
  offset_ = points_.front().y - slope * points_.front().x;
  for (const Point& p : points_) offset_ = std::min(offset_, p.y - slope * p.x);
}

void ClockFit::Fit() {
  if (points_.back().x - points_.front().x < options_.base_s * 1e6) return FitWithSlope(0);
  // Lower hull, from left to right (Andrew's monotone chain).
  std::vector<Point> hull;
  double mean = 0;
  for (const Point& p : points_) {
    mean += p.x / static_cast<double>(points_.size());
    while (hull.size() >= 2) {
      const Point& a = hull[hull.size() - 2];
      const Point& b = hull.back();
      if ((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) > 0) break;
      hull.pop_back();
    }
    hull.push_back(p);
  }
  std::size_t right = 1;
  while (right + 1 < hull.size() && hull[right].x < mean) ++right;
  const Point& a = hull[right - 1];
  const Point& b = hull[right];
  FitWithSlope(std::clamp((b.y - a.y) / (b.x - a.x), -options_.max_rate, options_.max_rate));
}

std::optional<Utime> ClockFit::ToHost(double ticks) const {
  if (empty_) return std::nullopt;
  const double x = (ticks - static_cast<double>(first_ticks_)) * options_.tick_us;
  return first_arrival_ + static_cast<Utime>(std::llround(x + offset_ + slope_ * x));
}

}  // namespace rgbdt
