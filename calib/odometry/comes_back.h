#pragma once

#include <Eigen/Core>
#include <vector>

namespace rgbdt {

/// Whether a way [m], given by places along it in their order, comes within 10 m of where it was
/// 50 m of way or more before: walls may stand twice in its map. Looks at a place each metre; takes
/// time in proportion to their number, times its logarithm.
bool ComesBack(const std::vector<Eigen::Vector3d>& places);

}  // namespace rgbdt
