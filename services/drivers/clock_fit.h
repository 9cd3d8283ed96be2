#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "calib/model/time.h"

namespace rgbdt {

/// A stamp of a clock that follows PTP, in UTC. PTP counts TAI, whole seconds ahead of UTC (37
/// since 2017), though some masters hand out UTC: how many, its arrival here tells. Nothing where
/// the two clocks are more than a minute or, apart from whole seconds, more than 0.2 s apart: then
/// it does not follow the same time.
std::optional<Utime> PtpToUtc(Utime stamp, Utime arrival);

/// A counter that wraps (SCIP: 24 bit of ms; Velodyne: us of the hour) as one that does not: each
/// reading becomes the value nearest to the one before, so late readings may come. After a silence
/// of half a period it can no longer tell: begin a new one.
class CounterUnwrapper {
 public:
  /// The counter's readings are 0 to period - 1.
  explicit CounterUnwrapper(std::int64_t period) : period_(period) {}
  std::int64_t Unwrap(std::int64_t reading);

 private:
  std::int64_t period_;
  std::optional<std::int64_t> last_;
};

struct ClockFitOptions {
  double tick_us = 1;        ///< of the device's clock [us]
  double window_s = 60;      ///< what came longer ago is forgotten
  int max_points = 600;      ///< kept of a window: of each stretch of it the one least delayed
  double base_s = 5;         ///< of readings, before a rate is fitted: till then it is 1
  double max_rate = 500e-6;  ///< bound of |rate - 1|
  Utime step_us = 50'000;    ///< a reading this much before the fit: somebody set a clock
  Utime step_wait_us = 2e6;  ///< readings this much behind it, for so long: likewise
  Utime min_delay_us = 0;    ///< known least delay of a reading

  /// Throws InputError naming the field and its value.
  void Check() const;
};

/// A device's clock on the host's, from readings that arrive late by unknown, varying delays:
///   arrival = offset + rate * device + delay, delay >= 0 and now and then near its least.
/// The fit is the line that no reading lies below and whose mean delay is least: of the lower
/// convex hull of (device, arrival) over a sliding window, the edge below the window's mean
/// (Moon, Skelly, Towsley: Estimation and removal of clock skew from network delay measurements,
/// INFOCOM 1999). A least delay that nobody knows stays in it as a constant.
///
/// Deterministic: only what is given counts, the machine's clock is not asked.
class ClockFit {
 public:
  explicit ClockFit(const ClockFitOptions& options = {});

  /// A reading of the device's clock [ticks, not wrapped] and when it arrived. `min_delay_us` [us]:
  /// known least delay of this one, besides that of the options. False: the device's clock or the
  /// host's was set, and the fit begins anew with this reading.
  bool Add(std::int64_t ticks, Utime arrival, Utime min_delay_us = 0);

  /// When the device's clock showed `ticks`, on the host's clock; nothing before the first reading.
  std::optional<Utime> ToHost(double ticks) const;

  /// Host's time that passes per device's, minus 1.
  double rate() const { return slope_; }
  /// Readings kept; 0 to max_points.
  std::size_t size() const { return points_.size(); }

 private:
  struct Point {
    double x = 0;  // device [us] since the first reading
    double y = 0;  // arrival minus x [us] since the first reading
    std::int64_t stretch = 0;
  };

  void Begin(std::int64_t ticks, Utime arrival);
  Point PointOf(std::int64_t ticks, Utime arrival) const;
  bool Stepped(const Point& point, Utime arrival);
  void Keep(const Point& point);
  void Fit();
  void FitWithSlope(double slope);

  ClockFitOptions options_;
  std::deque<Point> points_;  // in the order of x
  std::int64_t first_ticks_ = 0;
  Utime first_arrival_ = 0;
  double slope_ = 0, offset_ = 0;  // y = offset + slope * x
  std::optional<Utime> behind_since_;
  bool empty_ = true;
};

}  // namespace rgbdt
