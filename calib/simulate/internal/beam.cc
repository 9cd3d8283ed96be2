#include "calib/simulate/internal/beam.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rgbdt::simulate {
namespace {

/// Places in the unit disc: the middle, and rings of 6, 12, ... of which each stands for the same
/// area. Rings are turned so that no places line up with an upright or level edge.
std::vector<Eigen::Vector2d> DiscPlaces(int rings) {
  const double count = 1 + 3 * rings * (rings + 1);
  std::vector<Eigen::Vector2d> places{{0, 0}};
  for (int ring = 1; ring <= rings; ++ring) {
    // Radius that halves the ring's area; the ring starts where 1 + 3 ring (ring - 1) shares end.
    const double radius = std::sqrt((1 + 3 * ring * (ring - 1) + 3 * ring) / count);
    for (int i = 0; i < 6 * ring; ++i) {
      const double angle = 2 * M_PI * (i + 0.37 * ring) / (6 * ring);
      places.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
  }
  return places;
}

}  // namespace

BeamReturn CombineReturns(const BeamOptions& options, int sub_rays,
                          std::vector<SubReturn>* returns) {
  std::sort(returns->begin(), returns->end(),
            [](const SubReturn& a, const SubReturn& b) { return a.range < b.range; });
  double best_energy = 0;
  double best_range = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < returns->size();) {
    double energy = 0;
    double moment = 0;
    do {
      const SubReturn& r = (*returns)[i++];
      const double e = r.reflectivity / sub_rays / (r.range * r.range);
      energy += e;
      moment += e * r.range;
    } while (i < returns->size() &&
             (*returns)[i].range - (*returns)[i - 1].range < options.merge_m);
    if (energy > best_energy) {
      best_energy = energy;
      best_range = moment / energy;
    }
  }
  BeamReturn result{best_range, best_energy * best_range * best_range};
  // NaN, where nothing came back, fails this comparison too.
  if (!(result.intensity >= options.min_return * options.white_wall_reflectivity)) {
    result = {std::numeric_limits<double>::quiet_NaN(), 0};
  }
  return result;
}

std::vector<Eigen::Vector3d> SubRays(const BeamOptions& options, double elevation_rad) {
  const Eigen::Vector3d along(std::cos(elevation_rad), 0, std::sin(elevation_rad));
  const Eigen::Vector3d up(-std::sin(elevation_rad), 0, std::cos(elevation_rad));
  std::vector<Eigen::Vector3d> rays;
  for (const Eigen::Vector2d& place : DiscPlaces(options.divergence_rings)) {
    const Eigen::Vector2d off = place * std::tan(0.5 * options.divergence_rad);
    rays.push_back((along + off.x() * Eigen::Vector3d::UnitY() + off.y() * up).normalized());
  }
  return rays;
}

void CastBeams(const World& world, const BeamOptions& options, const Eigen::Vector3d& origin,
               const std::vector<Eigen::Vector3d>& directions, int sub_rays, BeamReturn* returns) {
  thread_local std::vector<Hit> hits;
  thread_local std::vector<SubReturn> met;
  hits.resize(directions.size());
  world.caster().CastFan(origin, directions.data(), static_cast<int>(directions.size()),
                         hits.data());
  const auto share = static_cast<std::size_t>(sub_rays);
  for (std::size_t first = 0; first < directions.size(); first += share) {
    met.clear();
    for (std::size_t i = first; i < first + share; ++i) {
      const Hit& hit = hits[i];
      if (!hit.hit() || hit.range > options.max_range_m) continue;
      met.push_back({hit.range, world.Reflectivity(hit, origin + hit.range * directions[i])});
    }
    *returns++ = CombineReturns(options, sub_rays, &met);
  }
}

namespace {

// One of black surfaces, zero of bright ones.
double Darkness(const BeamReturn& back) {
  const double grey = back.intensity / 0.3;
  return std::exp(-grey * grey);
}

}  // namespace

double RangeError(const BeamOptions& options, const BeamReturn& back) {
  return options.range_offset_m + options.dark_range_m * Darkness(back);
}

double RangeSigma(const BeamOptions& options, const BeamReturn& back) {
  return options.range_sigma_m * (1 + (options.dark_noise - 1) * Darkness(back));
}

float NoisyIntensity(const BeamOptions& options, const BeamReturn& back, double noise) {
  if (std::isnan(back.range)) return 0;
  return static_cast<float>(std::clamp(back.intensity + options.intensity_sigma * noise, 0.0, 1.0));
}

}  // namespace rgbdt::simulate
