#include "calib/fuse/temperature_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "calib/camera/simd_dispatch.h"
#include "calib/fuse/radiometry.h"

namespace rgbdt {
namespace {

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

void TemperatureTable::At(const float* counts, std::size_t count, float* kelvin,
                          float* sigma_k) const {
  if (table_.empty()) {
    std::fill_n(kelvin, count, kNone);
    std::fill_n(sigma_k, count, kNone);
  } else {
    AtSimd(table_.data(), counts, count, kelvin, sigma_k);
  }
}

RGBDT_SIMD_DISPATCH
void TemperatureTable::AtSimd(const Temperature* table, const float* counts, std::size_t count,
                              float* kelvin, float* sigma_k) {
  RGBDT_INDEPENDENT
  for (std::size_t i = 0; i < count; ++i) {
    const Temperature temperature = Between(table, counts[i]);
    kelvin[i] = temperature.kelvin;
    sigma_k[i] = temperature.sigma_k;
  }
}

bool TemperatureTable::IsFor(const Radiometry& radiometry) const {
  return Fields(radiometry) == Fields(radiometry_);
}

}  // namespace rgbdt
