#include "calib/simulate/internal/shading.h"

#include <algorithm>
#include <cmath>

namespace rgbdt::simulate {
namespace {

double SmoothStep(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// A light as one point sees it.
struct Beam {
  Eigen::Vector3d towards{0, 0, 1};  ///< unit
  double distance = 1e4;             ///< [m]
  double strength = 1;               ///< times Light::color
};

Beam BeamAt(const Light& light, const Eigen::Vector3d& point) {
  Beam beam;
  if (light.kind == Light::Kind::kSun) {
    beam.towards = light.place;
    return beam;
  }
  const Eigen::Vector3d offset = light.place - point;
  beam.distance = offset.norm();
  beam.towards = offset / beam.distance;
  const double ratio = light.reach_m / std::max(1.5, beam.distance);
  beam.strength = ratio * ratio;
  if (light.kind == Light::Kind::kLamp) {
    const double off_axis = std::acos(std::clamp(-beam.towards.x(), -1.0, 1.0));
    beam.strength *= 1 - SmoothStep(light.cone_rad, light.cone_rad * 1.25, off_axis);
    beam.strength *= 1 - SmoothStep(light.end_m, light.end_m + 1, beam.distance);
  }
  return beam;
}

/// Off the surface a little, against its own shadow.
Eigen::Vector3d Lifted(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) {
  return point + 1e-3 * normal;
}

Eigen::Vector3d SkyRadiance(const Sky& sky, const Eigen::Vector3d& d) {
  const double up = std::sqrt(std::clamp(d.z(), 0.0, 1.0));
  Eigen::Vector3d radiance = sky.horizon + (sky.zenith - sky.horizon) * up;
  if (sky.cloud > 0 && d.z() > 0) {
    const double x = 1.2 * d.x() / (d.z() + 0.15);
    const double y = 1.2 * d.y() / (d.z() + 0.15);
    const double noise = 0.6 * SmoothNoise(x, 2 * y) + 0.3 * SmoothNoise(2.7 * x, 5 * y + 9) +
                         0.15 * SmoothNoise(7 * x, 12 * y);
    radiance.array() += sky.cloud * SmoothStep(0.0, 0.6, noise);
  }
  return radiance;
}

Eigen::Vector3d PointOn(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                        const Hit& hit) {
  return origin + hit.range * direction;
}

double Footprint(const Hit& hit, const Eigen::Vector3d& direction, double pixel_rad) {
  return hit.range * pixel_rad / std::max(0.1, std::abs(hit.normal.dot(direction)));
}

std::uint64_t PatchNumber(const World& world, const Hit& hit, const Surface& surface,
                          unsigned shadows) {
  return (static_cast<std::uint64_t>(world.Face(hit)) << 32) |
         (static_cast<std::uint64_t>(surface.patch + 1) << 8) | shadows |
         (surface.material.leafy ? kLeafyPatch : 0);
}

/// What glass shows: the sky, or what is dark under it.
Eigen::Vector3d Mirrored(const World& world, const Eigen::Vector3d& direction,
                         const Eigen::Vector3d& normal) {
  const Eigen::Vector3d away = world.InWorld(direction - 2 * direction.dot(normal) * normal);
  return SkyRadiance(world.scene().sky, away) * SmoothStep(-0.05, 0.25, away.z());
}

/// What the sun has added to the warmth of a place [K].
double SunWarmth(const World& world, const Material& material, const Eigen::Vector3d& point,
                 const Eigen::Vector3d& normal, unsigned* shadows) {
  const Eigen::Vector3d& sun = world.scene().warming_sun;
  const double cosine = sun.dot(normal);
  if (material.sun_k == 0 || cosine <= 0) return 0;
  constexpr double kFar = 1e4;
  if (world.caster().Blocked(Lifted(point, normal), sun, kFar)) {
    *shadows = 1;
    return 0;
  }
  return material.sun_k * cosine;
}

}  // namespace

Eigen::Vector3d Irradiance(const World& world, const Eigen::Vector3d& point,
                           const Eigen::Vector3d& normal, unsigned* shadows) {
  *shadows = 0;
  // More light comes from above.
  Eigen::Vector3d sum = world.scene().ambient * (0.8 + 0.2 * normal.z());
  for (std::size_t i = 0; i < world.scene().lights.size(); ++i) {
    const Light& light = world.scene().lights[i];
    const Beam beam = BeamAt(light, point);
    const double cosine = beam.towards.dot(normal);
    if (cosine <= 0 || beam.strength <= 0) continue;
    if (light.casts_shadows &&
        world.caster().Blocked(Lifted(point, normal), beam.towards, beam.distance)) {
      *shadows |= 1U << i;
      continue;
    }
    sum += cosine * beam.strength * light.color;
  }
  return sum;
}

bool MayBeShadedByMoving(const World& world, const Eigen::Vector3d& point) {
  for (const Light& light : world.scene().lights) {
    if (!light.casts_shadows) continue;
    const Beam beam = BeamAt(light, point);
    if (beam.strength > 0 && world.MayMeetMoving(point, beam.towards)) return true;
  }
  return false;
}

Seen SeeColor(const World& world, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
              double pixel_rad) {
  const Hit hit = world.caster().Cast(origin, direction);
  Seen seen;
  seen.range = hit.range;
  if (!hit.hit()) {
    seen.value = SkyRadiance(world.scene().sky, world.InWorld(direction));
    return seen;
  }
  const Eigen::Vector3d point = PointOn(origin, direction, hit);
  const Surface surface = world.At(hit, point, Footprint(hit, direction, pixel_rad));
  unsigned shadows = 0;
  const Eigen::Vector3d light = Irradiance(world, point, hit.normal, &shadows);
  seen.value = surface.material.albedo.cwiseProduct(light);
  if (surface.material.mirror > 0) {
    seen.value += surface.material.mirror * Mirrored(world, direction, hit.normal);
  }
  seen.patch = PatchNumber(world, hit, surface, shadows);
  return seen;
}

Seen SeeHeat(const World& world, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
             double pixel_rad) {
  const Hit hit = world.caster().Cast(origin, direction);
  const Sky& sky = world.scene().sky;
  Seen seen;
  seen.range = hit.range;
  if (!hit.hit()) {
    const double up = std::sqrt(std::clamp(world.InWorld(direction).z(), 0.0, 1.0));
    seen.value[0] = sky.horizon_k + (sky.zenith_k - sky.horizon_k) * up;
    return seen;
  }
  const Eigen::Vector3d point = PointOn(origin, direction, hit);
  const Surface surface = world.At(hit, point, Footprint(hit, direction, pixel_rad));
  unsigned shadows = 0;
  const double warmth = SunWarmth(world, surface.material, point, hit.normal, &shadows);
  seen.value[0] =
      ApparentTemperature(surface.material.temperature_k + warmth, surface.material.emissivity,
                          world.scene().reflected_temperature_k);
  seen.patch = PatchNumber(world, hit, surface, shadows);
  return seen;
}

double ApparentTemperature(double temperature_k, double emissivity, double mirrored_k) {
  const double own = temperature_k * temperature_k;
  const double mirrored = mirrored_k * mirrored_k;
  return std::sqrt(std::sqrt(emissivity * own * own + (1 - emissivity) * mirrored * mirrored));
}

double SurfaceTemperature(double apparent_k, double emissivity, double mirrored_k) {
  const double apparent = apparent_k * apparent_k;
  const double mirrored = mirrored_k * mirrored_k;
  return std::sqrt(
      std::sqrt((apparent * apparent - (1 - emissivity) * mirrored * mirrored) / emissivity));
}

}  // namespace rgbdt::simulate
