#include "calib/simulate/lidar_options.h"

#include <algorithm>
#include <cmath>

#include "calib/model/errors.h"
#include "calib/simulate/internal/option_checks.h"

namespace rgbdt::simulate {

void BeamOptions::Check(const std::string& prefix) const {
  // Zero is refused because a rig file gives the range's sigma, which whitens residuals.
  kCheck.Positive(range_sigma_m, prefix + "range_sigma_m");
  kCheck.Between(divergence_rad, 0, 0.1, prefix + "divergence_rad");
  kCheck.Between(divergence_rings, 2, 8, prefix + "divergence_rings");
  kCheck.NotNegative(merge_m, prefix + "merge_m");
  kCheck.Between(min_return, 0, 1, prefix + "min_return");
  kCheck.Between(white_wall_reflectivity, 0.01, 1, prefix + "white_wall_reflectivity");
  kCheck.Positive(max_range_m, prefix + "max_range_m");
  kCheck.NotNegative(intensity_sigma, prefix + "intensity_sigma");
  kCheck.Between(range_offset_m, -1, 1, prefix + "range_offset_m");
  kCheck.Between(dark_range_m, -1, 1, prefix + "dark_range_m");
  kCheck.Between(dark_noise, 0.1, 100, prefix + "dark_noise");
}

int SpinningOptions::columns() const {
  return static_cast<int>(std::lround(360 * kDegree / azimuth_step_rad));
}

void SpinningOptions::Check() const {
  BeamOptions::Check("spinning.");
  kCheck.Between(rings(), 2, 1024, "number of spinning.elevations_rad");
  for (std::size_t i = 0; i < elevations_rad.size(); ++i) {
    kCheck.Between(elevations_rad[i], -89 * kDegree, 89 * kDegree, "spinning.elevations_rad");
    kCheck.Require(i == 0 || elevations_rad[i] > elevations_rad[i - 1], "spinning.elevations_rad",
                   elevations_rad[i], "more than that of the ring below");
  }
  kCheck.Between(azimuth_step_rad, 0.01 * kDegree, 10 * kDegree, "spinning.azimuth_step_rad");
  kCheck.Between(first_azimuth_rad, -360 * kDegree, 360 * kDegree, "spinning.first_azimuth_rad");
  kCheck.Between(revolution_s, 1e-3, 60, "spinning.revolution_s");
  kCheck.Between(firing_share, 0, 1, "spinning.firing_share");
  kCheck.Between(ring_bias_sigma_m, 0, 1, "spinning.ring_bias_sigma_m");
  kCheck.Between(beams_meet_m, 0, 0.2, "spinning.beams_meet_m");
}

void LivoxOptions::Check() const {
  BeamOptions::Check("livox.");
  kCheck.Between(seconds, 1e-3, 60, "livox.seconds");
  kCheck.Between(points_per_s, 1000, 10e6, "livox.points_per_s");
  kCheck.Positive(divergence_rad, "livox.divergence_rad");
  kCheck.Between(divergence_across_rad, 0, 0.1, "livox.divergence_across_rad");
  kCheck.Between(angle_sigma_rad, 0, 0.02, "livox.angle_sigma_rad");
}

LivoxOptions LivoxLidar(LivoxModel model) {
  LivoxOptions o;
  o.model = model;
  const bool avia = model == LivoxModel::kAvia;
  o.points_per_s = avia ? 240'000 : 200'000;
  o.range_sigma_m = 0.02;
  o.divergence_rad = 0.28 * kDegree;
  o.divergence_across_rad = 0.03 * kDegree;
  o.angle_sigma_rad = (avia ? 0.05 : 0.15) * kDegree;
  o.max_range_m = avia ? 190 : 40;
  return o;
}

SpinningOptions SpinningLidar(int rings) {
  struct Fan {
    int rings;
    double low, high;  // [degrees]
  };
  for (const Fan& fan : {Fan{16, -15, 15}, {32, -30.67, 10.67}, {64, -24.8, 2}, {128, -25, 15}}) {
    if (fan.rings != rings) continue;
    SpinningOptions o;
    for (int i = 0; i < rings; ++i) {
      o.elevations_rad.push_back((fan.low + (fan.high - fan.low) * i / (rings - 1)) * kDegree);
    }
    o.azimuth_step_rad = (rings == 64 ? 0.17 : 0.2) * kDegree;
    o.range_sigma_m = rings == 16 ? 0.02 : 0.015;
    o.divergence_rad = 3e-3;
    o.max_range_m = 100;
    return o;
  }
  throw InputError("simulator: no spinning LIDAR of " + std::to_string(rings) +
                   " rings; expected 16, 32, 64 or 128");
}

}  // namespace rgbdt::simulate
