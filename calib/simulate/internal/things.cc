#include "calib/simulate/internal/things.h"

namespace rgbdt::simulate {

using Eigen::Vector2d;
using Eigen::Vector3d;

Vector3d Rgb(double red, double green, double blue) { return {blue, green, red}; }

Material Paint(const Vector3d& albedo, double reflectivity, double temperature_k,
               const Texture& texture) {
  Material material;
  material.albedo = albedo;
  material.reflectivity = reflectivity;
  material.temperature_k = temperature_k;
  material.texture = texture;
  return material;
}

Material Glass(double temperature_k) {
  Material material = Paint(Rgb(0.02, 0.03, 0.035), 0, temperature_k);
  material.mirror = 0.6;
  material.emissivity = 0.87;
  return material;
}

Vector3d DrawPaint(Dice* draw) {
  static const std::vector<Vector3d> kPaints{
      Rgb(0.55, 0.07, 0.06), Rgb(0.06, 0.14, 0.42), Rgb(0.65, 0.65, 0.66), Rgb(0.04, 0.04, 0.045),
      Rgb(0.10, 0.27, 0.13), Rgb(0.70, 0.52, 0.08), Rgb(0.32, 0.33, 0.35), Rgb(0.42, 0.28, 0.16)};
  return kPaints[static_cast<std::size_t>(draw->Below(static_cast<int>(kPaints.size())))];
}

Material Warmed(Material material, const Warmth& warmth) {
  material.temperature_k = warmth.air_k;
  // Dark surfaces take up more of the sun.
  material.sun_k = warmth.sun_k * (1.1 - material.albedo.mean());
  return material;
}

void Thing::Add(const std::string& name, const Mesh& mesh, const Material& material) {
  parts_.push_back({name, mesh, Warmed(material, warmth_)});
}

void Thing::AddWarm(const std::string& name, const Mesh& mesh, const Material& material) {
  parts_.push_back({name, mesh, material});
}

void Thing::AddAll(const Rigid3& place, const Thing& other) {
  for (const SceneObject& part : other.parts_) {
    parts_.push_back({part.name, Transformed(place, part.mesh), part.material});
  }
}

Rigid3 Standing(double x, double y, double z, double turn_rad) {
  Rigid3 place;
  place.rotation = Eigen::AngleAxisd(turn_rad, Vector3d::UnitZ());
  place.translation = {x, y, z};
  return place;
}

Mesh MakeFrustum(const Vector2d& low0, const Vector2d& high0, double z0, const Vector2d& low1,
                 const Vector2d& high1, double z1) {
  Mesh mesh = MakeBox({0, 0, 0}, {1, 1, 1});
  for (Vector3d& v : mesh.vertices) {
    const Vector2d& low = v.z() > 0.5 ? low1 : low0;
    const Vector2d& high = v.z() > 0.5 ? high1 : high0;
    v = {v.x() > 0.5 ? high.x() : low.x(), v.y() > 0.5 ? high.y() : low.y(), v.z() > 0.5 ? z1 : z0};
  }
  return mesh;
}

Bounds BoundsOf(const Mesh& mesh) {
  Bounds extent{mesh.vertices[0], mesh.vertices[0]};
  for (const Vector3d& vertex : mesh.vertices) {
    extent.low = extent.low.cwiseMin(vertex);
    extent.high = extent.high.cwiseMax(vertex);
  }
  return extent;
}

}  // namespace rgbdt::simulate
