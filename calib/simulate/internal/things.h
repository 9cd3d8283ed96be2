#pragma once

#include <string>
#include <vector>

#include "calib/simulate/internal/dice.h"
#include "calib/simulate/internal/scene.h"

namespace rgbdt::simulate {

/// A colour as Light and Material hold it.
Eigen::Vector3d Rgb(double red, double green, double blue);

Material Paint(const Eigen::Vector3d& albedo, double reflectivity, double temperature_k,
               const Texture& texture = {});
/// Nothing of it returns to the LIDAR; it mirrors the sky.
Material Glass(double temperature_k);
/// A colour out of those that things are painted in.
Eigen::Vector3d DrawPaint(Dice* draw);

/// What shows what the weather does to a thing: its own temperature and what full sun adds [K].
struct Warmth {
  double air_k = 295, sun_k = 0;
};
Material Warmed(Material material, const Warmth& warmth);

/// A thing in a frame that stands on the ground [m]: z up. What moves as one.
class Thing {
 public:
  explicit Thing(const Warmth& warmth) : warmth_(warmth) {}

  /// A part as warm as what stands about.
  void Add(const std::string& name, const Mesh& mesh, const Material& material);
  /// A part whose material says how warm it is.
  void AddWarm(const std::string& name, const Mesh& mesh, const Material& material);
  void AddAll(const Rigid3& place, const Thing& other);
  const Warmth& warmth() const { return warmth_; }
  const std::vector<SceneObject>& parts() const { return parts_; }

 private:
  Warmth warmth_;
  std::vector<SceneObject> parts_;
};

/// Where a thing stands: turned about z, its origin at the place.
Rigid3 Standing(double x, double y, double z, double turn_rad);

/// Between a rectangle and another one above it, each from low to high.
Mesh MakeFrustum(const Eigen::Vector2d& low0, const Eigen::Vector2d& high0, double z0,
                 const Eigen::Vector2d& low1, const Eigen::Vector2d& high1, double z1);

/// Bounds along the axes.
struct Bounds {
  Eigen::Vector3d low, high;
};
Bounds BoundsOf(const Mesh& mesh);

}  // namespace rgbdt::simulate
