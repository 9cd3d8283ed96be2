#include "calib/files/points/internal/point_columns.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "calib/model/errors.h"

namespace rgbdt {
namespace {

// A time in seconds above this (1973) is one since 1970, below it one since the sweep's start.
constexpr double kAbsoluteSeconds = 1e8;

// The least and most that the times of a sweep, or of a packet, lie apart [s]; how long sweeps last
// as a rule.
constexpr double kLeastApart = 4e-4, kMostApart = 20, kShortSweep = 0.015, kUsualSweep = 0.1;
constexpr std::size_t kFewPoints = 100;  // which need not be of a whole sweep

// How far the times of points that returned lie apart, but for the first and last hundredth.
double ApartOf(const std::vector<double>& times, const records::Table& table) {
  const std::vector<Eigen::Vector3f> points = ReadVectors(table, "x", "y", "z");
  std::vector<double> kept;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const bool hit = points[i].allFinite() && !points[i].isZero(0);
    if (hit && std::isfinite(times[i])) kept.push_back(times[i]);
  }
  if (kept.size() < kFewPoints) return 0;
  const auto at = [&](std::size_t place) {
    const auto nth = kept.begin() + static_cast<std::ptrdiff_t>(place);
    std::nth_element(kept.begin(), nth, kept.end());
    return *nth;
  };
  const std::size_t cut = kept.size() / 100;
  const double least = at(cut);
  return at(kept.size() - 1 - cut) - least;
}

// The unit of a sweep's times [s]; nothing: they are nobody's.
std::optional<double> UnitOf(const std::vector<double>& times, bool whole,
                             const records::Table& table) {
  const double usual = whole ? 1e-9 : 1;
  const double apart = ApartOf(times, table);
  if (times.size() < kFewPoints) {
    double largest = 0;
    for (const double time : times) largest = std::max(largest, std::abs(time));
    return !whole && largest > 1e11 ? 1e-9 : usual;  // no clock is at 1e11 s
  }
  if (apart * usual >= kLeastApart && apart * usual <= kMostApart) return usual;
  std::optional<double> best;
  const auto unusual = [&](double unit) { return std::abs(std::log(apart * unit / kUsualSweep)); };
  for (const double unit : {1.0, 1e-3, 1e-6, 1e-9}) {
    if (!(apart * unit >= kShortSweep && apart * unit <= kMostApart)) continue;
    if (!best || unusual(unit) < unusual(*best)) best = unit;
  }
  return best;
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
    const auto unit = UnitOf(times, table.TypeOf(field) != 'F', table);
    if (!unit) return utime;
    for (const double value : times) {
      const double seconds = value * *unit;
      const Utime from = std::abs(seconds) < kAbsoluteSeconds ? sweep_utime : 0;
      utime.push_back(from + ToUtime(seconds * 1e6, where, field));
    }
    return utime;
  }
  return utime;
}

}  // namespace rgbdt
