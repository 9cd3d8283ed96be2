#include "calib/fuse/temperature_table.h"

#include <cmath>
#include <cstddef>
#include <limits>
#include <tuple>

#include "calib/fuse/radiometry.h"

namespace rgbdt {
namespace {

constexpr std::size_t kCounts = 65536;
constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

auto Fields(const Radiometry& r) {
  return std::tie(r.kind, r.gain, r.offset, r.r, r.b, r.f, r.o, r.emissivity,
                  r.reflected_temperature_k);
}

// Noise in counts: what the NETD, told for a black body at 300 K, is there. A sensor's noise in
// counts hardly depends on the scene.
double CountsSigma(const Radiometry& radiometry, double netd_k) {
  if (!(netd_k > 0)) return std::numeric_limits<double>::quiet_NaN();
  Radiometry black = radiometry;
  black.emissivity = 1;
  double per_count = radiometry.gain;
  if (radiometry.kind == Radiometry::Kind::kPlanck) {
    const double counts =
        radiometry.r / (std::exp(radiometry.b / 300) - radiometry.f) + radiometry.o;  // at 300 K
    per_count = 0.5 * (KelvinOf(black, counts + 1) - KelvinOf(black, counts - 1));
  }
  // Counts are whole numbers, besides.
  return std::sqrt(std::pow(netd_k / per_count, 2) + 1.0 / 12);
}

}  // namespace

TemperatureTable::TemperatureTable(const Radiometry& radiometry, double netd_k)
    : radiometry_(radiometry) {
  if (radiometry.kind == Radiometry::Kind::kNone) return;
  const double counts_sigma = CountsSigma(radiometry, netd_k);
  table_.resize(kCounts);
  for (std::size_t i = 0; i < kCounts; ++i) {
    const auto counts = static_cast<double>(i);
    const double slope =
        0.5 * (KelvinOf(radiometry, counts + 1) - KelvinOf(radiometry, counts - 1));
    table_[i] = {static_cast<float>(KelvinOf(radiometry, counts)),
                 static_cast<float>(std::abs(slope) * counts_sigma)};
  }
}

TemperatureTable::Temperature TemperatureTable::At(float counts) const {
  if (table_.empty() || !(counts >= 0) || !(counts <= static_cast<float>(kCounts - 1))) {
    return {kNone, kNone};
  }
  const auto low = static_cast<std::size_t>(counts);
  const Temperature& a = table_[low];
  const Temperature& b = table_[low + 1 < kCounts ? low + 1 : low];
  const float share = counts - static_cast<float>(low);
  // Not a + share (b - a): where b is none and share 0, a stands.
  if (share == 0) return a;
  return {a.kelvin + share * (b.kelvin - a.kelvin), a.sigma_k + share * (b.sigma_k - a.sigma_k)};
}

bool TemperatureTable::IsFor(const Radiometry& radiometry) const {
  return Fields(radiometry) == Fields(radiometry_);
}

}  // namespace rgbdt
