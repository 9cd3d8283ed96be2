#include "calib/simulate/internal/material.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "calib/simulate/internal/noise.h"

namespace rgbdt::simulate {
namespace {

/// -1 to 1, a function of the cell only.
double CellNoise(std::int64_t x, std::int64_t y) {
  const std::uint64_t bits = Noise::Mix(static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15ULL +
                                        static_cast<std::uint64_t>(y) * 0xc2b2ae3d27d4eb4fULL);
  return static_cast<double>(bits >> 11) * 0x1p-52 - 1.0;
}

/// The two axes that a face with this normal is painted along.
Eigen::Vector2d SurfaceCoordinates(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) {
  const Eigen::Vector3d size = normal.cwiseAbs();
  if (size.z() >= size.x() && size.z() >= size.y()) return {point.x(), point.y()};
  if (size.x() >= size.y()) return {point.y(), point.z()};
  return {point.x(), point.z()};
}

/// -1 to 1.
double Pattern(const Texture& texture, const Eigen::Vector2d& at) {
  const double x = at.x() / texture.size_m;
  const double y = at.y() / texture.size_m;
  switch (texture.kind) {
    case Texture::Kind::kNone:
      return 0;
    case Texture::Kind::kBlotches:
      return 0.6 * SmoothNoise(x, y) + 0.4 * SmoothNoise(3.1 * x + 17, 3.1 * y + 5);
    case Texture::Kind::kBricks: {
      const double row = std::floor(3 * y);
      const double along = x + (std::fmod(std::abs(row), 2) < 1 ? 0.0 : 0.5);
      const double joint = 0.012 / texture.size_m;
      const bool in_joint = along - std::floor(along) < joint || 3 * y - row < 3 * joint;
      if (in_joint) return 1;
      return 0.6 * CellNoise(static_cast<std::int64_t>(std::floor(along)),
                             static_cast<std::int64_t>(row)) -
             0.2;
    }
    case Texture::Kind::kTiles: {
      // Shades at random: two in turn would be a second checkerboard in the picture.
      const double joint = 0.01 / texture.size_m;
      if (x - std::floor(x) < joint || y - std::floor(y) < joint) return -1;
      return 0.8 * CellNoise(static_cast<std::int64_t>(std::floor(x)),
                             static_cast<std::int64_t>(std::floor(y)));
    }
    case Texture::Kind::kPlanks:
      return 0.7 * CellNoise(static_cast<std::int64_t>(std::floor(y)), 7) +
             0.3 * SmoothNoise(0.3 * x, 6 * y);
  }
  return 0;
}

}  // namespace

double SmoothNoise(double x, double y) {
  const double fx = std::floor(x);
  const double fy = std::floor(y);
  const auto ix = static_cast<std::int64_t>(fx);
  const auto iy = static_cast<std::int64_t>(fy);
  const double u = (x - fx) * (x - fx) * (3 - 2 * (x - fx));
  const double v = (y - fy) * (y - fy) * (3 - 2 * (y - fy));
  const double low = CellNoise(ix, iy) * (1 - u) + CellNoise(ix + 1, iy) * u;
  const double high = CellNoise(ix, iy + 1) * (1 - u) + CellNoise(ix + 1, iy + 1) * u;
  return low * (1 - v) + high * v;
}

Material Textured(const Material& material, const Eigen::Vector3d& point,
                  const Eigen::Vector3d& normal, double footprint_m) {
  if (material.texture.kind == Texture::Kind::kNone) return material;
  const double fade = std::clamp(material.texture.size_m / (8 * footprint_m + 1e-9) - 0.25, 0., 1.);
  if (fade <= 0) return material;
  const double pattern = fade * Pattern(material.texture, SurfaceCoordinates(point, normal));
  Material result = material;
  const double factor = std::max(0.05, 1 + material.texture.contrast * pattern);
  result.albedo = (material.albedo * factor).cwiseMin(0.95);
  result.reflectivity = std::min(0.95, material.reflectivity * factor);
  result.temperature_k += material.texture.temperature_k * pattern;
  return result;
}

}  // namespace rgbdt::simulate
