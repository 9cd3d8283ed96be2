#include "calib/simulate/internal/mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace rgbdt::simulate {
namespace {

/// Triangles between two rows of vertices, each closed on itself.
void AddBand(unsigned first_row, unsigned columns, Mesh* mesh) {
  for (unsigned column = 0; column < columns; ++column) {
    const unsigned a = first_row * columns + column;
    const unsigned b = first_row * columns + (column + 1) % columns;
    mesh->triangles.push_back({a, b, b + columns});
    mesh->triangles.push_back({a, b + columns, a + columns});
  }
}

}  // namespace

Mesh MakeQuad(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
              const Eigen::Vector3d& d) {
  return {{a, b, c, d}, {}, {{0, 1, 2}, {0, 2, 3}}};
}

Mesh MakeBox(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back((i & 1) != 0 ? high.x() : low.x(), (i & 2) != 0 ? high.y() : low.y(),
                               (i & 4) != 0 ? high.z() : low.z());
  }
  const std::array<std::array<unsigned, 4>, 6> faces{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  for (const auto& f : faces) {
    mesh.triangles.push_back({f[0], f[1], f[2]});
    mesh.triangles.push_back({f[0], f[2], f[3]});
  }
  return mesh;
}

Mesh MakePlateWithHole(const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                       const Eigen::Vector2d& centre, double radius) {
  // Round the hole: the polygon's corners and the plate's, which join two quadrilaterals.
  constexpr int kCorners = 128;
  std::vector<double> angles;
  angles.reserve(kCorners + 4);
  for (int i = 0; i < kCorners; ++i) angles.push_back(2 * M_PI * i / kCorners - M_PI);
  for (const double x : {low.x(), high.x()}) {
    for (const double y : {low.y(), high.y()}) {
      angles.push_back(std::atan2(y - centre.y(), x - centre.x()));
    }
  }
  std::sort(angles.begin(), angles.end());
  Mesh mesh;
  for (const double angle : angles) {
    const Eigen::Vector2d along(std::cos(angle), std::sin(angle));
    // How far the plate reaches that way.
    double reach = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 2; ++axis) {
      const double side = along[axis] > 0 ? high[axis] : low[axis];
      if (std::abs(along[axis]) > 1e-12) {
        reach = std::min(reach, (side - centre[axis]) / along[axis]);
      }
    }
    for (const double far : {radius, reach}) {
      for (const double z : {low.z(), high.z()}) {
        mesh.vertices.emplace_back(centre.x() + far * along.x(), centre.y() + far * along.y(), z);
      }
    }
  }
  const auto count = static_cast<unsigned>(angles.size());
  for (unsigned i = 0; i < count; ++i) {
    const unsigned a = 4 * i;
    const unsigned b = 4 * ((i + 1) % count);
    // Front, back, the hole's wall and the rim: 0 inner front, 1 inner back, 2 outer front, 3 back.
    for (const auto& [first, second] :
         std::array<std::pair<unsigned, unsigned>, 4>{{{0, 2}, {3, 1}, {1, 0}, {2, 3}}}) {
      mesh.triangles.push_back({a + first, a + second, b + second});
      mesh.triangles.push_back({a + first, b + second, b + first});
    }
  }
  return mesh;
}

void Add(const Mesh& part, Mesh* mesh) {
  const auto first = static_cast<unsigned>(mesh->vertices.size());
  mesh->vertices.insert(mesh->vertices.end(), part.vertices.begin(), part.vertices.end());
  for (const auto& t : part.triangles) {
    mesh->triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
}

Mesh MakeEllipsoid(const Eigen::Vector3d& centre, const Eigen::Vector3d& radii) {
  constexpr unsigned kRows = 16, kColumns = 28;
  Mesh mesh;
  for (unsigned row = 0; row <= kRows; ++row) {
    // Short of the poles by a little, so that no triangle is degenerate.
    const double latitude = M_PI * (0.001 + 0.998 * row / kRows) - M_PI / 2;
    for (unsigned column = 0; column < kColumns; ++column) {
      const double longitude = 2 * M_PI * column / kColumns;
      const Eigen::Vector3d unit(std::cos(latitude) * std::cos(longitude),
                                 std::cos(latitude) * std::sin(longitude), std::sin(latitude));
      mesh.vertices.emplace_back(centre + unit.cwiseProduct(radii));
      mesh.normals.push_back(unit.cwiseQuotient(radii).normalized());
    }
  }
  for (unsigned row = 0; row < kRows; ++row) AddBand(row, kColumns, &mesh);
  return mesh;
}

Mesh MakeRod(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double from_radius,
             double to_radius) {
  constexpr unsigned kColumns = 24;
  const Eigen::Vector3d axis = (to - from).normalized();
  const Eigen::Vector3d side =
      axis.cross(std::abs(axis.z()) < 0.9 ? Eigen::Vector3d(0, 0, 1) : Eigen::Vector3d(1, 0, 0))
          .normalized();
  const Eigen::Vector3d other = axis.cross(side);
  Mesh mesh;
  // Rims stand twice: once with the end's normal, once with the side's.
  struct Ring {
    Eigen::Vector3d centre;
    double radius, axial;
  };
  const std::array<Ring, 6> rings{{{from, from_radius * 1e-3, -1},
                                   {from, from_radius, -1},
                                   {from, from_radius, 0},
                                   {to, to_radius, 0},
                                   {to, to_radius, 1},
                                   {to, to_radius * 1e-3, 1}}};
  for (const Ring& ring : rings) {
    for (unsigned column = 0; column < kColumns; ++column) {
      const double angle = 2 * M_PI * column / kColumns;
      const Eigen::Vector3d unit = std::cos(angle) * side + std::sin(angle) * other;
      mesh.vertices.emplace_back(ring.centre + ring.radius * unit);
      mesh.normals.push_back(ring.axial == 0 ? unit : Eigen::Vector3d(ring.axial * axis));
    }
  }
  for (const unsigned row : {0U, 2U, 4U}) AddBand(row, kColumns, &mesh);
  return mesh;
}

Mesh Transformed(const Rigid3& a_from_b, Mesh mesh_in_b) {
  for (Eigen::Vector3d& vertex : mesh_in_b.vertices) vertex = a_from_b * vertex;
  for (Eigen::Vector3d& normal : mesh_in_b.normals) normal = a_from_b.rotation * normal;
  return mesh_in_b;
}

}  // namespace rgbdt::simulate
