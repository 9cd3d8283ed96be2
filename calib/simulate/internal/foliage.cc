#include "calib/simulate/internal/foliage.h"

#include <cmath>

namespace rgbdt::simulate {
namespace {

using Eigen::Vector3d;

Vector3d DrawUnit(Dice* draw) {
  const double z = draw->Between(-1, 1);
  const double angle = draw->Between(0, 2 * M_PI);
  const double flat = std::sqrt(1 - z * z);
  return {flat * std::cos(angle), flat * std::sin(angle), z};
}

void AddLeaf(Dice* draw, const Vector3d& centre, double length_m, Mesh* mesh) {
  const Vector3d along = 0.5 * length_m * DrawUnit(draw);
  const Vector3d across = 0.35 * length_m * along.cross(DrawUnit(draw)).normalized();
  const auto first = static_cast<unsigned>(mesh->vertices.size());
  mesh->vertices.insert(mesh->vertices.end(),
                        {centre - along, centre + across, centre + along, centre - across});
  mesh->triangles.push_back({first, first + 1, first + 2});
  mesh->triangles.push_back({first, first + 2, first + 3});
}

void Join(const Mesh& from, Mesh* to) {
  const auto first = static_cast<unsigned>(to->vertices.size());
  to->vertices.insert(to->vertices.end(), from.vertices.begin(), from.vertices.end());
  for (const auto& t : from.triangles) {
    to->triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
}

int Count(double usual, double leaves) { return std::max(1, static_cast<int>(usual * leaves)); }

}  // namespace

Material LeafMaterial(Dice* draw, const Warmth& warmth) {
  const double yellow = draw->Between(0.6, 1.3);
  Material material = Paint(Rgb(0.13 * yellow, 0.26, 0.06), 0.5, 0);
  material = Warmed(material, warmth);
  // Leaves give off water: sun warms them little.
  material.temperature_k -= 1;
  material.sun_k *= 0.2;
  material.leafy = true;
  return material;
}

Mesh MakeLeaves(Dice* draw, const Vector3d& centre, const Vector3d& radii, int count,
                double length_m) {
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const double radius = std::pow(draw->Between(0.02, 1), 0.28);
    AddLeaf(draw, centre + radius * DrawUnit(draw).cwiseProduct(radii), length_m, &mesh);
  }
  return mesh;
}

Mesh MakeHedge(Dice* draw, const Vector3d& low, const Vector3d& high, int count, double length_m) {
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    Vector3d place;
    for (int k = 0; k < 3; ++k) place[k] = draw->Between(low[k], high[k]);
    AddLeaf(draw, place, length_m, &mesh);
  }
  return mesh;
}

Thing MakeTree(Dice* draw, const Warmth& warmth, double height_m, double leaves) {
  Thing tree(warmth);
  const Material bark =
      Paint(Rgb(0.17, 0.12, 0.08), 0.35, 0, {Texture::Kind::kBlotches, 0.06, 0.5});
  const double fork = height_m * draw->Between(0.38, 0.45);
  const double thick = 0.025 * height_m;
  tree.Add("trunk", MakeRod({0, 0, -0.05}, {0, 0, fork}, thick, 0.75 * thick), bark);
  Mesh crown;
  const int clumps = 5;
  const double turn = draw->Between(0, 2 * M_PI);
  for (int i = 0; i < clumps; ++i) {
    const double angle = turn + 2 * M_PI * i / (clumps - 1);
    const double out = i == clumps - 1 ? 0 : 0.13 * height_m;
    const Vector3d middle(out * std::cos(angle), out * std::sin(angle),
                          height_m * (out == 0 ? 0.82 : draw->Between(0.6, 0.72)));
    tree.Add("branch", MakeRod({0, 0, fork - 0.1}, middle, 0.5 * thick, 0.15 * thick), bark);
    const double radius = height_m * draw->Between(0.13, 0.16);
    Join(MakeLeaves(draw, middle, {radius, radius, 0.9 * radius}, Count(240, leaves),
                    0.042 * height_m),
         &crown);
  }
  tree.AddWarm("leaves", crown, LeafMaterial(draw, warmth));
  return tree;
}

Thing MakeBush(Dice* draw, const Warmth& warmth, double height_m, double leaves) {
  Thing bush(warmth);
  const double radius = 0.45 * height_m;
  const Mesh crown = MakeLeaves(draw, {0, 0, 0.55 * height_m}, {radius, radius, 0.45 * height_m},
                                Count(450, leaves), 0.13 * height_m);
  bush.AddWarm("leaves", crown, LeafMaterial(draw, warmth));
  for (int i = 0; i < 3; ++i) {
    const Vector3d top{draw->Between(-0.5, 0.5) * radius, draw->Between(-0.5, 0.5) * radius,
                       0.7 * height_m};
    bush.Add("stem", MakeRod({0, 0, -0.02}, top, 0.02 * height_m, 0.008 * height_m),
             Paint(Rgb(0.17, 0.12, 0.08), 0.35, 0));
  }
  return bush;
}

}  // namespace rgbdt::simulate
