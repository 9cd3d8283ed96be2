#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "calib/model/rigid3.h"

namespace rgbdt::simulate {

/// Triangles [m]. A flat mesh is made of quadrilaterals, two triangles each, so `triangle / 2` is
/// the face; a round one carries normals and is shaded as if it were smooth.
struct Mesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3d> normals;  ///< unit, one a vertex; empty: flat
  std::vector<std::array<unsigned, 3>> triangles;

  bool round() const { return !normals.empty(); }
};

/// One side of a sheet; seen from both.
Mesh MakeQuad(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
              const Eigen::Vector3d& d);
/// Axis-aligned box between two corners.
Mesh MakeBox(const Eigen::Vector3d& low, const Eigen::Vector3d& high);
/// Axis-aligned plate between two corners, with a round hole through it along z; the hole's centre
/// and radius [m] must leave some of the plate on all sides. A polygon of 128 corners stands for
/// the circle: it is within 0.04 mm of one of 0.12 m.
Mesh MakePlateWithHole(const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                       const Eigen::Vector2d& centre, double radius);
/// Ellipsoid with its axes along x, y, z.
Mesh MakeEllipsoid(const Eigen::Vector3d& centre, const Eigen::Vector3d& radii);
/// Round rod with closed ends, tapering from one radius to the other.
Mesh MakeRod(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double from_radius,
             double to_radius);

/// More triangles, of a flat mesh.
void Add(const Mesh& part, Mesh* mesh);

Mesh Transformed(const Rigid3& a_from_b, Mesh mesh_in_b);

}  // namespace rgbdt::simulate
