#pragma once

// Rigs and clouds that tests and studies ask of the simulator besides its own.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "calib/model/cloud.h"
#include "calib/simulate/internal/noise.h"
#include "calib/simulate/options.h"

namespace rgbdt::simulate {

/// A fine, slow sweep: 800 lines of 900 beams, 720,000 points over the same field.
inline ScannerOptions DenseScanner() {
  constexpr double kLines = 800;
  ScannerOptions o;
  const double fan = o.angle_step_rad * (o.beams - 1);
  o.beams = 900;
  o.angle_step_rad = fan / (o.beams - 1);
  o.beam_period_s = o.sweep_rad / o.motor_speed_rad_s / kLines / o.beams;
  return o;
}

/// One colour camera of 4:3 and about 75 degrees, its lens known, and a spinning LIDAR.
inline Options OneCamera(std::uint64_t seed, int rings, int width) {
  Options options;
  options.seed = seed;
  UseLidar(rings, &options);
  CameraOptions camera = DefaultColorCamera();
  camera.width = width;
  camera.height = width * 3 / 4;
  camera.lens.fx = camera.lens.fy = width * 21. / 32;
  camera.lens.cx = width / 2.;
  camera.lens.cy = camera.height / 2.;
  options.cameras = {camera};
  options.supersampling = 2;
  return options;
}

/// Numbers 0 ... count - 1 in an order drawn from the seed (Fisher and Yates).
inline std::vector<std::size_t> DrawOrder(std::size_t count, std::optional<std::uint64_t> seed) {
  std::vector<std::size_t> order(count);
  for (std::size_t i = 0; i < count; ++i) order[i] = i;
  if (!seed) return order;
  const Noise noise(*seed, 0, "order");
  for (std::size_t i = count; i > 1; --i) std::swap(order[i - 1], order[noise.Bits(i) % i]);
  return order;
}

/// A cloud as most files hold it: hits only, without directions and origins, not organised.
/// `shuffle`: points in an order drawn from this seed.
inline Cloud Unorganised(const Cloud& cloud, bool keep_ring,
                         std::optional<std::uint64_t> shuffle = {}) {
  std::vector<std::size_t> hits;
  for (const std::size_t i : DrawOrder(cloud.size(), shuffle)) {
    if (cloud.IsHit(i)) hits.push_back(i);
  }
  const auto take = [&hits](const auto& from, auto* to) {
    if (from.empty()) return;
    to->reserve(hits.size());
    for (const std::size_t i : hits) to->push_back(from[i]);
  };
  Cloud result;
  result.sweep_utime = cloud.sweep_utime;
  result.organised = false;
  result.lines = 1;
  result.beams = static_cast<int>(hits.size());
  take(cloud.points, &result.points);
  take(cloud.intensity, &result.intensity);
  take(cloud.utime, &result.utime);
  if (keep_ring) take(cloud.ring, &result.ring);
  return result;
}

}  // namespace rgbdt::simulate
