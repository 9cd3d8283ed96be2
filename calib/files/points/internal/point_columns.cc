#include "calib/files/points/internal/point_columns.h"

#include <algorithm>
#include <cmath>

#include "calib/model/errors.h"

namespace rgbdt {
namespace {

// A time in seconds above this (1973) is one since 1970, below it one since the sweep's start.
constexpr double kAbsoluteSeconds = 1e8;

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
  for (const char* field : {"timestamp", "time", "t"}) {
    if (!table.Has(field)) continue;
    // Drivers that count in integers (Ouster's "t") count nanoseconds.
    const double seconds_per_unit = table.TypeOf(field) == 'F' ? 1 : 1e-9;
    for (const double value : table.Column(field)) {
      const double seconds = value * seconds_per_unit;
      const Utime from = std::abs(seconds) < kAbsoluteSeconds ? sweep_utime : 0;
      utime.push_back(from + ToUtime(seconds * 1e6, where, field));
    }
    return utime;
  }
  return utime;
}

}  // namespace rgbdt
