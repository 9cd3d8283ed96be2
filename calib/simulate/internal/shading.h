#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "calib/simulate/internal/world.h"

namespace rgbdt::simulate {

/// Set in the patch of leafy material.
inline constexpr std::uint64_t kLeafyPatch = std::uint64_t{1} << 31;

/// What one ray brings back.
struct Seen {
  Eigen::Vector3d value{0, 0, 0};  ///< colour: radiance, blue green red; thermal: [K] in the first
  std::uint64_t patch = 0;  ///< neighbouring rays that differ in it have an edge between them
  double range = 0;         ///< [m]; infinite: sky
};

/// Radiance along a ray, blue green red: 1 is a white sheet in full sun. Surfaces scatter evenly;
/// lights cast hard shadows. `pixel_rad` is the angle between two pixels.
Seen SeeColor(const World& world, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
              double pixel_rad);

/// Apparent temperature along a ray: what a black body would have to send the same.
Seen SeeHeat(const World& world, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
             double pixel_rad);

/// Light that falls on a surface from all sources, blue green red. `shadows` gets a bit for each
/// light that something stands in the way of.
Eigen::Vector3d Irradiance(const World& world, const Eigen::Vector3d& point,
                           const Eigen::Vector3d& normal, unsigned* shadows);

/// Whether board or stand may throw a shadow on the point (no false "no").
bool MayBeShadedByMoving(const World& world, const Eigen::Vector3d& point);

/// T_app^4 = e T^4 + (1 - e) T_mirrored^4 (Stefan and Boltzmann, all wavelengths alike) [K].
double ApparentTemperature(double temperature_k, double emissivity, double mirrored_k);
/// The inverse: how a surface's temperature follows from what a thermal camera's counts say.
double SurfaceTemperature(double apparent_k, double emissivity, double mirrored_k);

}  // namespace rgbdt::simulate
