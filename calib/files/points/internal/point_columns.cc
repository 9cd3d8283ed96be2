#include "calib/files/points/internal/point_columns.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "calib/model/errors.h"

namespace rgbdt {
namespace {

// A time in seconds above this (1973) is one since 1970, below it one since the sweep's start.
constexpr double kAbsoluteSeconds = 1e8;

constexpr double kFirstSeconds = 1e9, kLastSeconds = 4.2e9;                // 2001 to 2103
constexpr double kUsualSweep = 0.1, kShortSweep = 0.015, kLongSweep = 60;  // [s]
constexpr std::size_t kFewPoints = 100;  // which need not be of a whole sweep

// Of the points that returned.
std::vector<double> TimesOfHits(const std::vector<double>& times,
                                const std::vector<Eigen::Vector3f>& points) {
  std::vector<double> kept;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const bool hit = points[i].allFinite() && !points[i].isZero(0);
    if (hit && std::isfinite(times[i])) kept.push_back(times[i]);
  }
  return kept;
}

// The unit [s] that makes a sweep of these; nothing: none does. `whole`: they are integers.
std::optional<double> UnitOf(std::vector<double> times, bool whole) {
  const double usual = whole ? 1e-9 : 1;
  if (times.empty()) return usual;
  const auto at = [&](std::size_t place) {
    const auto nth = times.begin() + static_cast<std::ptrdiff_t>(place);
    std::nth_element(times.begin(), nth, times.end());
    return *nth;
  };
  // But for the first and last hundredth.
  const std::size_t cut = times.size() / 100;
  const double least = at(cut), middle = at(times.size() / 2);
  const double apart = at(times.size() - 1 - cut) - least;
  for (const double unit : {1.0, 1e-3, 1e-6, 1e-9}) {  // since 1970
    const double seconds = middle * unit;
    const bool since_1970 = seconds >= kFirstSeconds && seconds < kLastSeconds;
    if (since_1970 && apart * unit <= kLongSweep && !(whole && unit == 1)) return unit;
  }
  if (times.size() < kFewPoints) return !whole && middle > 1e11 ? 1e-9 : usual;
  if (apart == 0) return std::nullopt;
  const auto unusual = [&](double unit) { return std::abs(std::log(apart * unit / kUsualSweep)); };
  // Another one has to be far more usual: 30 times among integers, 100 times else.
  double best = usual, least_unusual = unusual(usual) - std::log(whole ? 30 : 100);
  for (const double unit : {1.0, 1e-3, 1e-6, 1e-9}) {
    const bool sweep = apart * unit >= kShortSweep && apart * unit <= kLongSweep;
    if (!sweep || !(unusual(unit) < least_unusual)) continue;
    best = unit;
    least_unusual = unusual(unit);
  }
  return apart * best <= kLongSweep ? std::optional(best) : std::nullopt;
}

Utime ToUtime(double microseconds, const std::string& where, const std::string& field) {
  // NaN as well; and the difference of two is to be a Utime.
  if (!(std::abs(microseconds) < 4e18)) {
    throw InputError(where + ": " + field + " holds " + std::to_string(microseconds) +
                     " us; expected a time");
  }
  return static_cast<Utime>(std::llround(microseconds));
}

}  // namespace

std::vector<Eigen::Vector3f> ReadVectors(const records::Table& table, const std::string& x,
                                         const std::string& y, const std::string& z) {
  const std::vector<double> xs = table.Column(x), ys = table.Column(y), zs = table.Column(z);
  std::vector<Eigen::Vector3f> vectors;
  vectors.reserve(xs.size());
  for (std::size_t i = 0; i < xs.size(); ++i) {
    vectors.emplace_back(static_cast<float>(xs[i]), static_cast<float>(ys[i]),
                         static_cast<float>(zs[i]));
  }
  return vectors;
}

std::vector<float> ReadIntensity(const records::Table& table) {
  const std::vector<double> values = table.Column("intensity");
  double largest = 0;
  for (const double value : values) {
    if (std::isfinite(value)) largest = std::max(largest, value);
  }
  const double one = largest <= 1 ? 1 : largest <= 255 ? 255 : std::max(largest, 65535.0);
  std::vector<float> intensity;
  intensity.reserve(values.size());
  for (const double value : values) {
    intensity.push_back(static_cast<float>(one == 1 ? value : value / one));
  }
  return intensity;
}

std::vector<Utime> ReadUtime(const records::Table& table, Utime sweep_utime,
                             const std::string& where) {
  std::vector<Utime> utime;
  if (table.Has("utime")) {
    for (const double value : table.Column("utime")) {
      utime.push_back(ToUtime(value, where, "utime"));
    }
    return utime;
  }
  for (const char* field : {"timestamp", "time_stamp", "time", "t", "offset_time"}) {
    if (!table.Has(field)) continue;
    const std::vector<double> times = table.Column(field);
    const std::vector<Eigen::Vector3f> points = ReadVectors(table, "x", "y", "z");
    const auto unit = UnitOf(TimesOfHits(times, points), table.TypeOf(field) != 'F');
    if (!unit) return utime;
    for (std::size_t i = 0; i < times.size(); ++i) {
      if (std::isnan(times[i]) && !points[i].allFinite()) {  // a miss may have none
        utime.push_back(sweep_utime);
        continue;
      }
      const double seconds = times[i] * *unit;
      const Utime from = std::abs(seconds) < kAbsoluteSeconds ? sweep_utime : 0;
      utime.push_back(from + ToUtime(seconds * 1e6, where, field));
    }
    return utime;
  }
  return utime;
}

}  // namespace rgbdt
