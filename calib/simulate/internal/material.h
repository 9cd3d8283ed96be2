#pragma once

#include <Eigen/Core>

namespace rgbdt::simulate {

/// A pattern over a surface, a function of place only.
struct Texture {
  enum class Kind {
    kNone,
    kBlotches,  ///< soft noise, `size_m` wide
    kBricks,    ///< bricks of size_m x size_m / 3 with light joints
    kTiles,     ///< squares in random shades, dark joints
    kPlanks,    ///< stripes along the first axis, each in a shade of its own
  };
  Kind kind = Kind::kNone;
  double size_m = 0.2;
  double contrast = 0.3;       ///< of the albedo, as a share of it
  double temperature_k = 0.0;  ///< [K] half the difference that the pattern makes
};

/// What a surface looks like to each sensor.
struct Material {
  Eigen::Vector3d albedo{0.5, 0.5, 0.5};  ///< blue, green, red: what it scatters of the light
  double reflectivity = 0.5;              ///< at the LIDAR's wavelength, 0 to 1
  double temperature_k = 295;
  double emissivity = 0.95;
  Texture texture;
  double sun_k = 0;    ///< [K] what sun from straight above it adds, once it has shone for long
  double mirror = 0;   ///< share of the sky's light that it mirrors
  bool leafy = false;  ///< of many small sheets: rendered with fewer rays a pixel
};

/// A material at a place: its texture applied. `footprint_m` is how far two pixels lie apart there;
/// patterns that are finer fade, so that no moire is seen.
Material Textured(const Material& material, const Eigen::Vector3d& point,
                  const Eigen::Vector3d& normal, double footprint_m);

/// Smooth noise in the plane, -1 to 1, with features of size 1.
double SmoothNoise(double x, double y);

}  // namespace rgbdt::simulate
