#pragma once

#include "calib/simulate/internal/things.h"

namespace rgbdt::simulate {

/// What leaves look like to each sensor.
Material LeafMaterial(Dice* draw, const Warmth& warmth);

/// Leaves of this length [m] in all directions, spread over an ellipsoid, denser outwards.
Mesh MakeLeaves(Dice* draw, const Eigen::Vector3d& centre, const Eigen::Vector3d& radii, int count,
                double length_m);
/// The same, evenly over a box along the axes.
Mesh MakeHedge(Dice* draw, const Eigen::Vector3d& low, const Eigen::Vector3d& high, int count,
               double length_m);

/// A trunk, branches and a crown of leaves; the crown is as wide as 0.5 to 0.6 times its height.
/// `leaves`: their number, times the usual.
Thing MakeTree(Dice* draw, const Warmth& warmth, double height_m, double leaves);
Thing MakeBush(Dice* draw, const Warmth& warmth, double height_m, double leaves);

}  // namespace rgbdt::simulate
